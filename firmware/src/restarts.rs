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
//! content, nobody knows. And it says of a reset whether it was asked for, which the chip cannot tell from one of its
//! own.

use core::cell::Cell;
use core::mem::MaybeUninit;
use embassy_time::Duration;
use estimator_core::DacCode;
use protocol::ResetCause;

/// So many such starts in a row are too many.
pub const TOO_MANY: u32 = 3;
/// A device that has run for so long has not failed soon after its start.
pub const SOON: Duration = Duration::from_secs(10);

/// What is known of the starts before.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Restarts {
    /// How often the device has started in a row without having been asked to.
    pub count: u32,
    /// The DAC's safe code then.
    pub safe: Option<DacCode>,
    /// A displacement had been told since the last reset that was asked for.
    pub told: bool,
    /// This start was asked for over the link.
    pub asked: bool,
}

impl Restarts {
    /// Of a start before which none is known.
    pub const NONE: Self = Self { count: 0, safe: None, told: false, asked: false };

    /// Whether the store is to be left alone.
    pub fn too_many(&self) -> bool {
        self.count >= TOO_MANY
    }
}

/// Three numbers, each with its complement, without which it is none: after power-on the memory holds anything.
#[derive(Clone, Copy, Default)]
#[repr(C)]
struct Kept {
    count: [u32; 2],
    safe: [u32; 2],
    event: [u32; 2],
}

/// What is no number, since the second is not the complement of the first: nothing is kept.
const NONE: [u32; 2] = [0, 0];
/// The event that a displacement was told, until a reset is asked for.
const TOLD: u32 = 1;
/// The event that the reset which comes now was asked for.
const ASKED: u32 = 2;

fn sealed(number: u32) -> [u32; 2] {
    [number, !number]
}

fn unsealed([number, check]: [u32; 2]) -> Option<u32> {
    (check == !number).then_some(number)
}

/// A place in memory for what the starts leave each other, which need not have been written.
pub struct Place(Cell<MaybeUninit<Kept>>);

impl Default for Place {
    fn default() -> Self {
        Self(Cell::new(MaybeUninit::new(Kept::default())))
    }
}

/// The place that no reset clears.
struct Lasting(Place);

// SAFETY: it is used through the `Memory` alone that the boot hands out once, which stays with the main loop.
unsafe impl Sync for Lasting {}

#[cfg_attr(target_os = "none", unsafe(link_section = ".uninit.restarts"))]
static LASTING: Lasting = Lasting(Place(Cell::new(MaybeUninit::uninit())));

/// Where the starts leave each other what they know. It stays with the main loop: neither it nor a reference to it can
/// be sent to an interrupt.
#[derive(Clone, Copy)]
pub struct Memory<'m>(&'m Place);

/// The memory that no reset clears.
///
/// # Safety
/// Once, at boot, by what becomes the main loop.
pub unsafe fn memory() -> Memory<'static> {
    Memory(&LASTING.0)
}

impl<'m> Memory<'m> {
    /// Memory of a board that has no such place: it lasts as long as its owner.
    pub fn new(place: &'m Place) -> Self {
        Self(place)
    }

    fn change(self, change: impl FnOnce(&mut Kept)) {
        let place: *mut Kept = self.0.0.as_ptr().cast();
        // SAFETY: a cell's own pointer, on the one thread that has it. What the program has not written lies in memory
        // that it does not initialise: a volatile read has what the reset has left there, and every bit pattern is
        // numbers. Written volatile, because this program may not read it again.
        let mut kept = unsafe { place.read_volatile() };
        change(&mut kept);
        // SAFETY: as above.
        unsafe { place.write_volatile(kept) };
    }

    /// Counts this start: once, before all else.
    pub fn count(self, reset: ResetCause) -> Restarts {
        let mut restarts = Restarts::NONE;
        self.change(|kept| {
            restarts.count = next(unsealed(kept.count), reset);
            // Where there were starts before, they have kept it. Else it is forgotten, or the starts after this one
            // would take it for this one's, which may know none.
            if restarts.count == 0 {
                kept.safe = NONE;
            }
            restarts.safe = unsealed(kept.safe).map(|safe| DacCode(safe as u16));
            restarts.told = unsealed(kept.event) == Some(TOLD);
            restarts.asked = unsealed(kept.event) == Some(ASKED) && reset.contains(ResetCause::SOFTWARE);
            if !restarts.told {
                kept.event = NONE;
            }
            kept.count = sealed(restarts.count);
        });
        restarts
    }

    /// Keeps the safe code of this start for the next ones.
    pub fn keep_safe(self, DacCode(code): DacCode) {
        self.change(|kept| kept.safe = sealed(code.into()));
    }

    /// Keeps for the next starts that a displacement was told.
    pub fn keep_told(self) {
        self.change(|kept| kept.event = sealed(TOLD));
    }

    /// Begins the count anew: the device has run for [`SOON`].
    pub fn forget(self) {
        self.change(|kept| kept.count = sealed(0));
    }

    /// The reset that comes now has been asked for: it does not count, and whoever asked knows that it loses what was
    /// told.
    pub fn asked(self) {
        self.change(|kept| (kept.count, kept.event) = (NONE, sealed(ASKED)));
    }
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
    fn the_count_is_kept_until_it_is_forgotten_and_the_safe_code_with_it() {
        let own = ResetCause::SOFTWARE;
        let place = Place::default();
        let memory = Memory::new(&place);
        memory.forget();
        memory.keep_safe(DacCode(512));
        let after = |count, safe| Restarts { count, safe, ..Restarts::NONE };
        let safe = Some(DacCode(512));
        assert_eq!([memory.count(own), memory.count(own)], [after(1, safe), after(2, safe)]);
        memory.forget();
        assert_eq!(memory.count(own).count, 1);
        let begins_anew: [&dyn Fn(); 2] = [&|| memory.asked(), &|| _ = memory.count(ResetCause::BROWN_OUT)];
        for begins_anew in begins_anew {
            memory.keep_safe(DacCode(512));
            begins_anew();
            assert_eq!(memory.count(own).safe, None, "the output may have been wired anew");
            memory.asked();
            let asked = Restarts { asked: true, ..Restarts::NONE };
            assert_eq!([memory.count(own), memory.count(own)], [asked, after(1, None)], "asked for once");
        }
        memory.keep_safe(DacCode(700));
        let [.., third] = [memory.count(own), memory.count(own), memory.count(own)];
        assert!(third.too_many() && third.safe == Some(DacCode(700)));
    }

    #[test]
    fn what_was_told_is_forgotten_by_the_reset_that_is_asked_for_and_by_no_other() {
        let own = ResetCause::SOFTWARE;
        let place = Place::default();
        let memory = Memory::new(&place);
        memory.keep_told();
        for cause in [own, ResetCause::WATCHDOG, ResetCause::PIN, ResetCause::BROWN_OUT, ResetCause::empty()] {
            assert!([memory.count(cause), memory.count(cause)].iter().all(|start| start.told), "{cause:?}");
        }
        memory.asked();
        assert!([own, own].iter().all(|&cause| !memory.count(cause).told));
        memory.asked();
        assert!(!memory.count(ResetCause::BROWN_OUT).asked, "power came before the reset that was asked for");
        memory.asked();
        assert!(!memory.count(ResetCause::WATCHDOG).asked, "so did the watchdog");
        memory.change(|kept| kept.event = [TOLD, TOLD]);
        assert!(!memory.count(own).told, "as memory may be after the loss of power");
    }
}
