//! What a list of shaders says.

/// A shader to build.
pub(crate) struct Permutation {
    pub name: String,
    pub entry: String,
    pub features: Vec<String>,
}

/// The permutations of a line: `name entry feature… [optional|alternatives]…`. Each bracket doubles
/// them, or more; what is taken of it is appended to the name.
pub(crate) fn permutations_of(line: &str) -> Vec<Permutation> {
    let line = line.split('#').next().unwrap_or_default();
    let mut words = line.split_whitespace();
    let Some(name) = words.next() else {
        return Vec::new();
    };
    let entry = words.next().unwrap_or_default();
    let mut found = vec![Permutation {
        name: name.to_owned(),
        entry: entry.to_owned(),
        features: Vec::new(),
    }];
    for word in words {
        let choices = word.strip_prefix('[').and_then(|w| w.strip_suffix(']'));
        let Some(choices) = choices else {
            for permutation in &mut found {
                permutation.features.push(word.to_owned());
            }
            continue;
        };
        let with = |permutation: &Permutation, choice: &str| {
            let mut features = permutation.features.clone();
            features.push(choice.to_owned());
            Permutation {
                name: format!("{}+{choice}", permutation.name),
                entry: permutation.entry.clone(),
                features,
            }
        };
        let chosen: Vec<Permutation> = choices
            .split('|')
            .flat_map(|choice| found.iter().map(move |p| with(p, choice)))
            .collect();
        found.extend(chosen);
    }
    found
}
