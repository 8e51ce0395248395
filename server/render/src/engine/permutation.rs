//! A shader and the features that are on.

/// A line of a `permutations.txt`, put together from its parts: `shade` with `mapped` and `grids` is
/// `shade+mapped+grids`. Features are given in the order in which the list names them.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) struct Permutation {
    name: String,
    shader_length: usize,
}

impl Permutation {
    /// Without features.
    pub fn of(shader: &str) -> Self {
        Self {
            name: shader.to_owned(),
            shader_length: shader.len(),
        }
    }

    /// With another feature.
    pub fn with(mut self, feature: &str) -> Self {
        self.name.push('+');
        self.name.push_str(feature);
        self
    }

    /// With another feature, if `on`.
    pub fn with_if(self, on: bool, feature: &str) -> Self {
        if on { self.with(feature) } else { self }
    }

    /// The same features of another shader.
    pub fn of_shader(&self, shader: &str) -> Self {
        Self {
            name: format!("{shader}{}", self.features()),
            shader_length: shader.len(),
        }
    }

    /// Name in the list.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The features as the name has them, each after a `+`.
    pub fn features(&self) -> &str {
        &self.name[self.shader_length..]
    }
}

impl From<&str> for Permutation {
    fn from(shader: &str) -> Self {
        Self::of(shader)
    }
}
