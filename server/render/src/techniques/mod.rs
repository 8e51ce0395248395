//! Light transport, one file a technique; none imports another.

pub(crate) mod area_lights;
pub(crate) mod reference;
pub(crate) mod shadow_maps;
pub(crate) mod single_scattering;
pub(crate) mod surfaces;
