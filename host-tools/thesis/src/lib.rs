//! The tables and figures of the thesis's chapters 3 to 5 and of its Appendices B and C that numbers can reproduce,
//! each beside what it prints: one item a file. The thesis's figures come from its own actuator, ours from the
//! synthetic rig or from a user's logs.

mod added_term;
mod bench;
mod black_box;
mod convergence;
mod elsewhere;
mod error;
mod errors;
mod extremum_terms;
mod features;
mod hysteresis;
mod loops;
mod monotone;
mod optimisers;
mod parameters;
mod range;
mod rate;
mod sampling_time;
mod search;
mod shapes;
mod tracking;
mod without_lag;

pub use bench::{Bench, QUICK_SEEDS};
pub use error::ThesisError;
use identification::{Progress, SearchOptions};
use report::Section;

macro_rules! items {
    ($(#[doc = $line:literal] $item:ident, $name:literal, $module:ident;)*) => {
        /// What can be reproduced.
        #[derive(Clone, Copy, PartialEq, Eq, Debug)]
        pub enum Item {
            $(#[doc = $line] $item,)*
            /// Every item, one after the other.
            All,
        }

        impl Item {
            /// Each by itself.
            pub const EACH: [Self; [$($name),*].len()] = [$(Self::$item),*];

            /// Its name on the command line and in JSON.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$item => $name,)* Self::All => "all" }
            }

            /// What it is, in a line.
            pub fn description(self) -> &'static str {
                match self { $(Self::$item => $line,)* Self::All => "Everything" }.trim_ascii().trim_end_matches('.')
            }

            /// Generations that it takes, roughly, for a progress bar. Only `elsewhere` has seeds.
            #[allow(unreachable_patterns, reason = "the one with seeds is among the items, too")]
            pub fn generations(self, search: &SearchOptions, seeds: u32) -> u64 {
                match self {
                    Self::Elsewhere => u64::from(seeds) * elsewhere::generations(search),
                    $(Self::$item => $module::generations(search),)*
                    Self::All => Self::EACH.into_iter().map(|item| item.generations(search, seeds)).sum(),
                }
            }

            fn section(self, bench: &mut Bench, progress: Progress<'_>) -> Result<Option<Section>, ThesisError> {
                let section = match self {
                    $(Self::$item => $module::section(bench, progress),)*
                    Self::All => return Ok(None),
                };
                section.map(Some).map_err(|source| ThesisError::Item { item: self.name(), source: Box::new(source) })
            }
        }
    };
}

items! {
    /// Validation errors: Tables 4.8, 5.3, 5.4, 5.5, Figures 4.11 and 5.1 to 5.6.
    Errors, "errors", errors;
    /// Validation error over the sampling time: Table 4.4, Figure 4.8.
    SamplingTime, "sampling-time", sampling_time;
    /// Parameters and their ranges: Tables 4.5, 4.6, 5.2.
    Parameters, "parameters", parameters;
    /// Modelling and validation error over the search: Table 4.7, Figures 4.9 and 4.10.
    Convergence, "convergence", convergence;
    /// NARX with and without extrema: Table 5.1.
    BlackBox, "black-box", black_box;
    /// Population and bits of the search: Tables C.1, C.2.
    Search, "search", search;
    /// Recorded signals and loops: Appendix B.
    Loops, "loops", loops;
    /// Rate dependence, frequency range, reversibility: Table 3.1.
    Features, "features", features;
    /// The rig driven by each model's inverse, beside plain scaling.
    Tracking, "tracking", tracking;
    /// The extremum terms tried on every model: Section 6.2.
    ExtremumTerms, "extremum-terms", extremum_terms;
    /// Optimisers at equal budget: Section 6.2.
    Optimisers, "optimisers", optimisers;
    /// What was learnt judged on what was not: other sessions, amplitudes, frequencies, waveforms, devices.
    Elsewhere, "elsewhere", elsewhere;
}

impl Item {
    /// What some arguments ask for, each item once, in the order of [`Self::EACH`].
    pub fn asked(arguments: &[Self]) -> Vec<Self> {
        let asked = |item: &Self| arguments.contains(item) || arguments.contains(&Self::All);
        Self::EACH.into_iter().filter(asked).collect()
    }
}

/// Reproduces some items, in the order given. One that has nothing to show says why in its place.
///
/// # Errors
/// None of them has anything to show: why the first has not.
pub fn run(bench: &mut Bench, items: &[Item], progress: Progress<'_>) -> Result<Vec<(Item, Section)>, ThesisError> {
    let (mut sections, mut failed) = (Vec::new(), Vec::new());
    for &item in items {
        match item.section(bench, progress) {
            Ok(section) => sections.extend(section.map(|section| (item, section))),
            Err(why) => {
                sections.push((item, Section::failed(&(bench.say)(&why))));
                failed.push(why);
            }
        }
    }
    let all = failed.len() == sections.len();
    failed.into_iter().next().filter(|_| all).map_or(Ok(sections), Err)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_is_each_once_and_what_is_named_twice_is_done_once() {
        assert_eq!(Item::asked(&[Item::All, Item::Loops]), Item::EACH);
        assert_eq!(Item::asked(&[Item::Loops, Item::Errors, Item::Loops]), [Item::Errors, Item::Loops]);
        assert_eq!(Item::SamplingTime.name(), "sampling-time");
        assert!([Item::ExtremumTerms, Item::Optimisers].iter().all(|item| Item::EACH.contains(item)));
    }
}
