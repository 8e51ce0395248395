//! Picture files, as modules of one binary.

mod mutations;
