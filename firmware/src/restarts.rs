//! How often the device has started again in a row without having been asked to: by a panic, a hard fault or the watchdog, each
//! time soon after its start. The count lies in memory that no reset clears.
//!
//! A device that fails because of what is stored would fail for ever. So after [`TOO_MANY`] such starts the store is left
//! alone, the output is safe, and the link is there to mend it.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;
use embassy_time::Duration;
use protocol::ResetCause;

/// So many such starts in a row are too many.
pub const TOO_MANY: u32 = 3;
/// A device that has run for so long has not failed soon after its start.
pub const SOON: Duration = Duration::from_secs(10);

/// The count, and its complement, without which it is none: after power-on the memory holds anything.
struct Place(UnsafeCell<MaybeUninit<[u32; 2]>>);

// SAFETY: there is one core, and `count` and `forget` say when they may be called.
unsafe impl Sync for Place {}

#[cfg_attr(target_os = "none", unsafe(link_section = ".uninit.restarts"))]
static PLACE: Place = Place(UnsafeCell::new(MaybeUninit::uninit()));

/// Counts this start, and says how many there have been in a row.
///
/// # Safety
/// Once, at boot, before interrupts and tasks.
pub unsafe fn count(reset: ResetCause) -> u32 {
    // SAFETY: by the caller's promise. Every bit pattern is two numbers.
    let [before, check] = unsafe { PLACE.0.get().read_volatile().assume_init() };
    let count = next((check == !before).then_some(before), reset);
    // SAFETY: by the caller's promise.
    unsafe { set(count) };
    count
}

/// Begins the count anew: the device has run for [`SOON`].
///
/// # Safety
/// From the main loop alone.
pub unsafe fn forget() {
    // SAFETY: by the caller's promise.
    unsafe { set(0) };
}

/// The reset that comes now has been asked for: it does not count.
///
/// # Safety
/// From the main loop alone.
pub unsafe fn asked() {
    // SAFETY: by the caller's promise. No count at all.
    unsafe { PLACE.0.get().write_volatile(MaybeUninit::new([0, 0])) };
}

/// # Safety
/// As for [`count`] or [`forget`].
unsafe fn set(count: u32) {
    // SAFETY: by the caller's promise. Volatile, because this program never reads it again.
    unsafe { PLACE.0.get().write_volatile(MaybeUninit::new([count, !count])) };
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
    }

    #[test]
    fn the_count_is_kept_until_it_is_forgotten() {
        // SAFETY: no other test uses the place.
        unsafe {
            forget();
            assert_eq!([count(ResetCause::WATCHDOG), count(ResetCause::SOFTWARE)], [1, 2]);
            forget();
            assert_eq!(count(ResetCause::WATCHDOG), 1);
            asked();
            assert_eq!([count(ResetCause::SOFTWARE), count(ResetCause::SOFTWARE)], [0, 1]);
        }
    }
}
