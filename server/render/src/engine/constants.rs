//! Values of the constants that pipelines are built for, by their names in WESL.

use std::collections::BTreeMap;

use tyndall_shaders::Shader;

/// Override constants; each shader takes those it declares and ignores the others.
#[derive(Debug, Clone, Default, PartialEq, Eq, Hash)]
pub(crate) struct Constants {
    values: BTreeMap<&'static str, u32>,
}

impl Constants {
    /// With a number.
    pub fn number(mut self, name: &'static str, value: u32) -> Self {
        self.values.insert(name, value);
        self
    }

    /// With a truth value.
    pub fn flag(self, name: &'static str, value: bool) -> Self {
        self.number(name, value.into())
    }

    /// These, and `others`, which win where both have a name.
    pub fn with(&self, others: &Self) -> Self {
        let mut values = self.values.clone();
        values.extend(&others.values);
        Self { values }
    }

    /// Key and value of each that `shader` declares: what its pipeline depends on.
    pub fn of(&self, shader: &Shader) -> Vec<(&'static str, u32)> {
        let value = |name: &str| self.values.get(name).copied();
        shader
            .overrides
            .iter()
            .filter_map(|declared| Some((declared.key, value(declared.name)?)))
            .collect()
    }

    /// Names that `shader` declares and these lack: it would silently take its own default.
    #[cfg(test)]
    pub fn missing(&self, shader: &Shader) -> Vec<&'static str> {
        let names = shader.overrides.iter().map(|declared| declared.name);
        names
            .filter(|name| !self.values.contains_key(name))
            .collect()
    }
}
