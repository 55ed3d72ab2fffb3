//! Many units' files, read one by one: one that is broken hides no other.

use crate::error::UnitError;
use crate::member::{Member, members};
use crate::outlier::{Outlier, Quantity, outliers};
use crate::row::{Row, State};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

/// Units that should not have something in common.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
#[serde(tag = "alike", rename_all = "kebab-case")]
pub enum Alike {
    /// Folders of one unit's name.
    Name {
        /// The name that they share.
        unit: String,
        /// Paths of the folders, as they were named.
        folders: Vec<String>,
    },
    /// Units that were learnt from the same logs.
    Logs {
        /// Names of the units.
        units: Vec<String>,
    },
}

/// All that is known of a fleet.
#[derive(Clone, Debug, Serialize)]
pub struct Fleet {
    /// The units, in the order in which their folders were named, and by name within one folder.
    pub units: Vec<Row>,
    /// What units have in common that they should not.
    pub alike: Vec<Alike>,
    /// Units that are far from the rest in something.
    pub outliers: Vec<Outlier>,
}

impl Fleet {
    /// Of folders of units, or of folders that hold some; `said` puts into words what is wrong with a unit's file.
    pub fn read(folders: &[PathBuf], said: impl Fn(&UnitError) -> String) -> Self {
        Self::of(&members(folders), said)
    }

    /// Of units that were read.
    pub fn of(members: &[Member], said: impl Fn(&UnitError) -> String) -> Self {
        let units: Vec<Row> = members.iter().map(|member| Row::of(member, &said)).collect();
        let of = |quantity: Quantity| {
            let value = |row: &Row| Some((row.unit.clone(), value(row, quantity)?));
            outliers(quantity, &units.iter().filter_map(value).collect::<Vec<_>>())
        };
        let outliers = Quantity::ALL.into_iter().flat_map(of).collect();
        Self { alike: alike(members), outliers, units }
    }

    /// Units of a state.
    pub fn count(&self, state: State) -> usize {
        self.units.iter().filter(|row| row.status == state).count()
    }

    /// Whether every unit has a table.
    pub fn complete(&self) -> bool {
        self.count(State::Identified) == self.units.len()
    }
}

fn value(row: &Row, quantity: Quantity) -> Option<f64> {
    match quantity {
        Quantity::ErrorPercent => row.held_out_mae_percent,
        Quantity::HalfWidthPercent => row.half_width_percent,
        Quantity::StrokeUm => row.stroke_um,
    }
}

fn alike(members: &[Member]) -> Vec<Alike> {
    let (mut names, mut logs) = (BTreeMap::<_, Vec<_>>::new(), BTreeMap::<_, BTreeSet<_>>::new());
    for (folder, unit) in members.iter().filter_map(|member| Some((&member.folder, member.unit.as_ref().ok()?))) {
        names.entry(unit.unit.to_string()).or_default().push(folder.display().to_string());
        if let Some(identified) = unit.identified() {
            logs.entry(&identified.asked.inputs).or_default().insert(unit.unit.to_string());
        }
    }
    let names = names.into_iter().filter(|(_, folders)| folders.len() > 1);
    let logs = logs.into_values().filter(|units| units.len() > 1);
    let names = names.map(|(unit, folders)| Alike::Name { unit, folders });
    names.chain(logs.map(|units| Alike::Logs { units: units.into_iter().collect() })).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::unit::tests::{identified, unit};
    use crate::unit::{Ended, Unit};
    use std::fs;

    fn fleet(units: Vec<Unit>) -> Fleet {
        let member = |unit: Unit| Member { folder: PathBuf::from(unit.unit.to_string()), unit: Ok(unit) };
        Fleet::of(&units.into_iter().map(member).collect::<Vec<_>>(), ToString::to_string)
    }

    #[test]
    fn a_unit_that_is_unlike_the_rest_is_named_with_what_it_is_unlike_in() {
        let mut units: Vec<_> =
            (1..=6).map(|n| identified(&format!("SN{n}"), 0.2 + 0.01 * f64::from(n), 2.0)).collect();
        units.push(identified("SN7", 1.1, 2.0));
        units.push(identified("SN8", 0.2, 9.0));
        let far: Vec<_> = fleet(units).outliers.into_iter().map(|outlier| (outlier.unit, outlier.quantity)).collect();
        assert_eq!(far, [("SN7".to_owned(), Quantity::ErrorPercent), ("SN8".to_owned(), Quantity::HalfWidthPercent)]);
    }

    #[test]
    fn units_of_one_name_and_units_of_the_same_logs_are_seen() {
        let mut copied = identified("SN2", 0.2, 2.0);
        copied.unit = "SN3".parse().unwrap();
        let mut again = identified("SN1", 0.3, 2.0);
        if let Ended::Identified(of) = &mut again.ended {
            of.asked.inputs = "others".to_owned();
        }
        let units = vec![identified("SN1", 0.2, 2.0), identified("SN2", 0.2, 2.0), copied, again];
        let folders = vec!["SN1".to_owned(); 2];
        assert_eq!(
            fleet(units).alike,
            [
                Alike::Name { unit: "SN1".to_owned(), folders },
                Alike::Logs { units: vec!["SN2".to_owned(), "SN3".to_owned()] }
            ]
        );
    }

    #[test]
    fn a_run_that_goes_on_is_told_from_one_that_was_killed() {
        let folder = tempfile::tempdir().unwrap();
        let at = folder.path().join("SN1");
        let held = result_files::Held::of(&at).unwrap();
        fs::write(at.join("unit.json"), serde_json::to_string(&unit("SN1", Ended::Begun)).unwrap()).unwrap();
        let state = || Fleet::read(&[folder.path().to_owned()], ToString::to_string).units.remove(0).status;
        assert_eq!(state(), State::Running);
        drop(held);
        assert_eq!(state(), State::Killed);
    }

    #[test]
    fn a_folder_of_units_a_unit_s_own_and_its_file_are_each_taken_once() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        for name in ["SN2", "SN1", "SN3", ".hidden"] {
            fs::create_dir(at(name)).unwrap();
        }
        fs::write(at("SN1/unit.json"), serde_json::to_string(&identified("SN1", 0.2, 2.0)).unwrap()).unwrap();
        fs::write(at("SN2/unit.json"), "{").unwrap();
        let named = [folder.path().to_owned(), at("SN1"), at("SN1/unit.json"), at("SN9")];
        let fleet = Fleet::read(&named, ToString::to_string);
        let states: Vec<_> = fleet.units.iter().map(|row| (row.unit.as_str(), row.status)).collect();
        let expected =
            [("SN1", State::Identified), ("SN2", State::Unreadable), ("SN3", State::Missing), ("SN9", State::Missing)];
        assert_eq!(states, expected);
        assert!(!fleet.complete() && fleet.count(State::Missing) == 2);
    }
}
