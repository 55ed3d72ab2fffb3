//! How often the device has started again in a row without having been asked to: by a panic, a hard fault or the
//! watchdog, each time soon after its start. The count lies in memory that no reset clears.
//!
//! A device that fails because of what is stored would fail for ever. So after [`TOO_MANY`] such starts the store is
//! left alone, the output is safe, and the link is there to mend it. Which code is the safe one only the stored table
//! says; the one of the starts before lies beside the count. A start that begins the count anew knows no such code: the
//! output may have been wired anew before it.
//!
//! Beside both lies whether a displacement was told, which every reset loses. Whoever relies on it is to hear so of any
//! that nobody has asked for over the link, of the pin's and the supply's as well; where the memory has lost its
//! content, nobody knows.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;
use embassy_time::Duration;
use estimator_core::DacCode;
use protocol::ResetCause;

/// So many such starts in a row are too many.
pub const TOO_MANY: u32 = 3;
/// A device that has run for so long has not failed soon after its start.
pub const SOON: Duration = Duration::from_secs(10);

/// What is known of the starts before.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Restarts {
    /// How often the device has started in a row without having been asked to.
    pub count: u32,
    /// The DAC's safe code then.
    pub safe: Option<DacCode>,
    /// A displacement had been told since the last reset that was asked for.
    pub told: bool,
}

impl Restarts {
    /// Whether the store is to be left alone.
    pub fn too_many(&self) -> bool {
        self.count >= TOO_MANY
    }
}

/// Three numbers, each with its complement, without which it is none: after power-on the memory holds anything.
#[derive(Clone, Copy)]
#[repr(C)]
struct Kept {
    count: [u32; 2],
    safe: [u32; 2],
    told: [u32; 2],
}

/// What is no number, since the second is not the complement of the first: nothing is kept.
const NONE: [u32; 2] = [0, 0];
/// The number that says that a displacement was told.
const TOLD: u32 = 1;

fn sealed(number: u32) -> [u32; 2] {
    [number, !number]
}

fn unsealed([number, check]: [u32; 2]) -> Option<u32> {
    (check == !number).then_some(number)
}

/// The place in memory.
struct Place(UnsafeCell<MaybeUninit<Kept>>);

// SAFETY: there is one core, and the functions say when they may be called.
unsafe impl Sync for Place {}

#[cfg_attr(target_os = "none", unsafe(link_section = ".uninit.restarts"))]
static PLACE: Place = Place(UnsafeCell::new(MaybeUninit::uninit()));

/// Changes what is kept.
///
/// # Safety
/// By the main loop alone, or before it.
unsafe fn change(change: impl FnOnce(&mut Kept)) {
    // SAFETY: by the caller's promise. Every bit pattern is numbers.
    let mut kept = unsafe { PLACE.0.get().read_volatile().assume_init() };
    change(&mut kept);
    // SAFETY: by the caller's promise. Volatile, because this program may not read it again.
    unsafe { PLACE.0.get().write_volatile(MaybeUninit::new(kept)) };
}

/// Counts this start.
///
/// # Safety
/// Once, at boot, before interrupts and tasks.
pub unsafe fn count(reset: ResetCause) -> Restarts {
    let mut restarts = Restarts::default();
    let count = |kept: &mut Kept| {
        restarts.count = next(unsealed(kept.count), reset);
        // Where there were starts before, they have kept it. Else it is forgotten, or the starts after this one would
        // take it for this one's, which may know none.
        if restarts.count == 0 {
            kept.safe = NONE;
        }
        restarts.safe = unsealed(kept.safe).map(|safe| DacCode(safe as u16));
        restarts.told = unsealed(kept.told) == Some(TOLD);
        kept.count = sealed(restarts.count);
    };
    // SAFETY: by the caller's promise.
    unsafe { change(count) };
    restarts
}

/// Keeps the safe code of this start for the next ones.
///
/// # Safety
/// As for [`count`], or by the main loop.
pub unsafe fn keep_safe(DacCode(code): DacCode) {
    // SAFETY: by the caller's promise.
    unsafe { change(|kept| kept.safe = sealed(code.into())) };
}

/// Keeps for the next starts that a displacement was told.
///
/// # Safety
/// By the main loop alone.
pub unsafe fn keep_told() {
    // SAFETY: by the caller's promise.
    unsafe { change(|kept| kept.told = sealed(TOLD)) };
}

/// Begins the count anew: the device has run for [`SOON`].
///
/// # Safety
/// By the main loop alone.
pub unsafe fn forget() {
    // SAFETY: by the caller's promise.
    unsafe { change(|kept| kept.count = sealed(0)) };
}

/// The reset that comes now has been asked for: it does not count, and whoever asked knows that it loses what was told.
///
/// # Safety
/// By the main loop alone.
pub unsafe fn asked() {
    // SAFETY: by the caller's promise. No count at all.
    unsafe { change(|kept| (kept.count, kept.told) = (NONE, NONE)) };
}

/// The count at a start, from the one before, if there was one.
fn next(before: Option<u32>, reset: ResetCause) -> u32 {
    let unasked = reset.intersects(ResetCause::WATCHDOG.union(ResetCause::SOFTWARE));
    match before {
        Some(before) if unasked && !reset.contains(ResetCause::BROWN_OUT) => before.saturating_add(1),
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn starts_that_nobody_asked_for_are_counted_and_any_other_begins_anew() {
        let own = ResetCause::SOFTWARE | ResetCause::PIN;
        assert_eq!(next(Some(0), own), 1);
        assert_eq!(next(Some(2), ResetCause::WATCHDOG | ResetCause::PIN), 3);
        assert_eq!(next(Some(u32::MAX), own), u32::MAX);
        for other in [ResetCause::PIN, ResetCause::BROWN_OUT | own, ResetCause::OTHER, ResetCause::empty()] {
            assert_eq!(next(Some(2), other), 0, "{other:?}");
        }
        assert_eq!(next(None, own), 0, "garbage is no count");
        assert_eq!((unsealed([7, !7]), unsealed([7, 7])), (Some(7), None));
    }

    #[test]
    fn the_count_is_kept_until_it_is_forgotten_and_the_safe_code_with_it_and_what_was_told_until_a_reset_is_asked_for()
    {
        let own = ResetCause::SOFTWARE;
        // SAFETY: no other test uses the place.
        unsafe {
            forget();
            keep_safe(DacCode(512));
            let safe = Some(DacCode(512));
            assert_eq!([count(own), count(own)], [1, 2].map(|count| Restarts { count, safe, told: false }));
            forget();
            assert_eq!(count(own).count, 1);
            for begins_anew in [asked, || _ = count(ResetCause::BROWN_OUT)] {
                keep_safe(DacCode(512));
                begins_anew();
                assert_eq!(count(own).safe, None, "the output may have been wired anew");
                asked();
                assert_eq!([count(own), count(own)], [0, 1].map(|count| Restarts { count, safe: None, told: false }));
            }
            keep_safe(DacCode(700));
            let [.., third] = [count(own), count(own), count(own)];
            assert!(third.too_many() && third.safe == Some(DacCode(700)));
            // What was told, the reset that is asked for forgets, and no other.
            keep_told();
            for cause in [own, ResetCause::WATCHDOG, ResetCause::PIN, ResetCause::BROWN_OUT, ResetCause::empty()] {
                assert!([count(cause), count(cause)].iter().all(|start| start.told), "{cause:?}");
            }
            asked();
            assert!([own, own].iter().all(|&cause| !count(cause).told));
            change(|kept| kept.told = [TOLD, TOLD]);
            assert!(!count(own).told, "as memory may be after the loss of power");
        }
    }
}
