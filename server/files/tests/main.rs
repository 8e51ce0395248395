//! Files of strangers, as modules of one binary.

mod mutations;
