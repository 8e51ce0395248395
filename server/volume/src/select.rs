//! Which grid of a file is meant.

use crate::VolumeError;

/// Most names that an error lists.
const LISTED: usize = 32;
/// Longest part of a name that an error shows. Unit: character.
const SHOWN: usize = 64;

/// A grid of a file, as far as choosing it needs.
#[derive(Debug)]
pub(crate) struct Candidate {
    /// Name, without the number that tells grids of one name apart.
    pub(crate) name: String,
    /// Name as a person writes it: `density[1]` where several have one name.
    pub(crate) address: String,
    /// Why it cannot be read, if it cannot: its type.
    pub(crate) obstacle: Option<String>,
}

/// The index of the grid of that name, else the one named "density", else the first that can be
/// read.
pub(crate) fn choose(grids: &[Candidate], wanted: Option<&str>) -> Result<usize, VolumeError> {
    if let Some(wanted) = wanted {
        let found = grids
            .iter()
            .position(|grid| grid.address == wanted)
            .or_else(|| grids.iter().position(|grid| grid.name == wanted));
        let Some(index) = found else {
            return Err(VolumeError::invalid("grid", shown(wanted), listed(grids)));
        };
        return match &grids[index].obstacle {
            None => Ok(index),
            Some(obstacle) => Err(VolumeError::unsupported(
                format!("grid {}", shown(wanted)),
                obstacle.clone(),
            )),
        };
    }
    let readable = |grid: &Candidate| grid.obstacle.is_none();
    let index = grids
        .iter()
        .position(|grid| grid.name == "density" && readable(grid))
        .or_else(|| grids.iter().position(readable));
    match (index, grids.first()) {
        (Some(index), _) => Ok(index),
        (None, None) => Err(VolumeError::invalid("grids", "none", "at least one")),
        (None, Some(first)) => Err(VolumeError::unsupported(
            format!("grid {}", shown(&first.address)),
            first.obstacle.clone().unwrap_or_default(),
        )),
    }
}

/// A name in quotes, cut short.
pub(crate) fn shown(name: &str) -> String {
    let cut: String = name.chars().take(SHOWN).collect();
    format!("{cut:?}")
}

fn listed(grids: &[Candidate]) -> String {
    let mut names: Vec<String> = grids
        .iter()
        .take(LISTED)
        .map(|grid| shown(&grid.address))
        .collect();
    if grids.len() > LISTED {
        names.push(format!("{} more", grids.len() - LISTED));
    }
    names.join(", ")
}
