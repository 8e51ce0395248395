//! Passes that several techniques share: each file plans and records its own and says what it reads,
//! writes and keeps. None of them knows a technique.

pub(crate) mod area_lights;
pub(crate) mod estimate;
pub(crate) mod film;
pub(crate) mod in_scatter;
pub(crate) mod light_volume;
pub(crate) mod shadow_maps;
pub(crate) mod surfaces;
pub(crate) mod tonemap;
pub(crate) mod visibility;
