//! Every model in seconds, so that they can be compared: a search that stops long before its last digit.

use crate::family;
use crate::fit::{Fit, Identification, Progress};
use crate::search::{Optimiser, SearchOptions};
use estimator_core::Model;
use rayon::prelude::*;
use std::sync::{Mutex, PoisonError};

/// One in so many of the search's candidates a number is tried for the models whose weights are solved for.
const OF_OTHERS: u32 = 6;
/// A model of the Voigt family, whose candidates are cheap and whose numbers are all searched, may try so many times
/// the search's candidates a number in all.
const OF_VOIGT: u32 = 8;

/// Candidates that a brief search tries.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Brief {
    /// For each number that is searched, of the models whose weights are solved for.
    pub of_a_number: u32,
    /// In all, of a model of the Voigt family.
    pub of_voigt: u32,
}

impl Brief {
    /// What is left of a search.
    pub fn of(search: &SearchOptions) -> Self {
        Self {
            of_a_number: (search.evaluations / OF_OTHERS).max(1),
            of_voigt: search.evaluations.saturating_mul(OF_VOIGT),
        }
    }
}

impl Identification<'_> {
    /// Each of these models by a [`Brief`] search of the method for the models beyond the Voigt family; a
    /// [smooth](Self::smooth) one at length, which takes no longer.
    pub fn brief(&self, models: &[Model], progress: Progress<'_>) -> Vec<Fit> {
        let Brief { of_a_number, of_voigt } = Brief::of(self.options);
        let (family, others): (Vec<Model>, Vec<Model>) = models.iter().partition(|model| model.is_voigt());
        let options = SearchOptions { evaluations: of_a_number, ..self.options.clone() };
        let search = |budget| Identification { options: &options, budget, ..*self };
        let progress = Mutex::new(progress);
        let tell = |model, cost| progress.lock().unwrap_or_else(PoisonError::into_inner)(model, cost);
        let of = |&model| {
            let search = if self.smooth(model) { *self } else { search(None) };
            search.run(&[model], &mut |model, cost| tell(model, cost))
        };
        // None of the others starts from another. They are begun from the list's end, where NARX is: it takes as long
        // as all the rest.
        let (others, mut fits) = rayon::join(
            || others.par_iter().rev().map(of).collect::<Vec<_>>(),
            || search(Some(of_voigt as usize)).run(&family, &mut |model, cost| tell(model, cost)),
        );
        fits.extend(others.into_iter().rev().flatten());
        fits
    }

    /// Whether a model is found by slopes, a search that soon ends by itself.
    pub fn smooth(&self, model: Model) -> bool {
        let structures = family::of(model, self.problem);
        self.options.optimiser == Optimiser::Local
            && !structures.is_empty()
            && structures.iter().all(|family| family.smooth())
    }
}
