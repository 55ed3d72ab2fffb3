//! A button and a lamp on the board itself: the button calls the displacement of now 0, the lamp says how
//! the device is.
//!
//! | lamp | |
//! |---|---|
//! | on | the output is the estimate, or follows a reference, and nothing is wrong |
//! | blinks once a second | nothing is wrong, but the output is the safe one: paused, fed by the host, or a drive at rest |
//! | blinks five times a second | a fault |
//! | dark for half a second | the button has been obeyed; where it may not be, nothing happens |

use protocol::Faults;

/// How long the button must show the same for it to count, ms.
const BOUNCES_MS: u64 = 30;
/// How long the lamp stays dark to say that the button was obeyed, ms.
const DARK_MS: u64 = 500;

/// A board's button and lamp. Where there are none, `()` stands for them.
pub trait Front {
    /// Whether the button is held down.
    fn held(&mut self) -> bool;
    /// Switches the lamp.
    fn light(&mut self, on: bool);
}

impl Front for () {
    fn held(&mut self) -> bool {
        false
    }

    fn light(&mut self, _: bool) {}
}

/// The button's bounces and the lamp's rhythm.
pub struct Panel<P> {
    front: P,
    pressed: bool,
    /// Since when (ms) the button shows something else than it counts for.
    other_since: Option<u64>,
    dark_until: u64,
}

impl<P: Front> Panel<P> {
    /// A panel. A button that is held down from the start on has not been pressed.
    pub fn new(mut front: P) -> Self {
        let pressed = front.held();
        Self { front, pressed, other_since: None, dark_until: 0 }
    }

    /// To be called every few milliseconds: whether the button has been pressed since the last time.
    pub fn pressed(&mut self, now_ms: u64) -> bool {
        let shows_pressed = self.front.held();
        if shows_pressed == self.pressed {
            self.other_since = None;
            return false;
        }
        if now_ms.saturating_sub(*self.other_since.get_or_insert(now_ms)) < BOUNCES_MS {
            return false;
        }
        self.pressed = shows_pressed;
        shows_pressed
    }

    /// Says that the button was obeyed.
    pub fn obeyed(&mut self, now_ms: u64) {
        self.dark_until = now_ms + DARK_MS;
    }

    /// To be called every few milliseconds with what is wrong: the lamp says so.
    pub fn show(&mut self, now_ms: u64, faults: Faults) {
        let on = if now_ms < self.dark_until {
            false
        } else if !faults.difference(Faults::SAFE_OUTPUT).is_empty() {
            now_ms % 200 < 100
        } else {
            faults.is_empty() || now_ms % 1000 < 500
        };
        self.front.light(on);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Default)]
    struct Parts {
        held: bool,
        lit: bool,
    }

    impl Front for &mut Parts {
        fn held(&mut self) -> bool {
            self.held
        }

        fn light(&mut self, on: bool) {
            self.lit = on;
        }
    }

    /// When the button counts as pressed that is held down at these times, ms.
    fn presses(held: impl Fn(u64) -> bool) -> Vec<u64> {
        let mut parts = Parts { held: held(0), ..Parts::default() };
        let mut panel = Panel::new(&mut parts);
        let mut pressed = |now| {
            panel.front.held = held(now);
            panel.pressed(now)
        };
        (0..1000).step_by(4).filter(|&now| pressed(now)).collect()
    }

    #[test]
    fn a_press_counts_once_and_bounces_do_not() {
        // A spike, a press that bounces at both ends, another spike.
        let held = |now| {
            (20..36).contains(&now)
                || (100..400).contains(&now) && !(104..108).contains(&now)
                || (412..420).contains(&now)
                || (800..824).contains(&now)
        };
        assert_eq!(presses(held), [140]);
    }

    #[test]
    fn a_button_held_from_the_start_on_counts_only_when_it_is_pressed_again() {
        assert_eq!(presses(|now| now < 200), []);
        assert_eq!(presses(|now| now < 200 || (500..600).contains(&now)), [532]);
    }

    #[test]
    fn the_lamp_tells_good_resting_and_faulty_apart() {
        let mut parts = Parts::default();
        let mut panel = Panel::new(&mut parts);
        let mut changes = |faults, from: u64| {
            let shown: Vec<bool> = (from..from + 1000)
                .map(|now| {
                    panel.show(now, faults);
                    panel.front.lit
                })
                .collect();
            (shown[0], shown.windows(2).filter(|pair| pair[0] != pair[1]).count())
        };
        assert_eq!(changes(Faults::empty(), 0), (true, 0));
        assert_eq!(changes(Faults::SAFE_OUTPUT, 0), (true, 1));
        assert_eq!(changes(Faults::SAFE_OUTPUT | Faults::ADC_STUCK, 0), (true, 9));
        panel.obeyed(3000);
        for (now, lit) in [(3000, false), (3499, false), (3500, true)] {
            panel.show(now, Faults::empty());
            assert_eq!(panel.front.lit, lit, "{now}");
        }
    }
}
