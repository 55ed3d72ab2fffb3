//! What the tick and the link hand each other: single-producer, single-consumer queues, so that neither waits.

use crate::rate::ticks_in;
use estimator_core::AdcCode;
use heapless::spsc::{Consumer, Producer, Queue};
use protocol::{Mode, Playback, Sample};

/// What the link tells the tick.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Command {
    /// Change the mode; the estimate goes on where both modes measure.
    SetMode(Mode),
    /// Play the waveform that has been loaded, in [`Mode::Waveform`].
    Play(Playback),
    /// Tell the bias by a displacement that is known now.
    SetZero {
        /// What the displacement of now is called, µm.
        at_um: f32,
    },
    /// Shift the bias that is added to the estimate.
    ShiftBias {
        /// What is added to the displacement from now on, µm.
        by_um: f32,
    },
    /// Follow the references that wait and those that come.
    Go {
        /// Hold the last reference until the mode ends, which for a voltage is 5 s after the host's last word
        /// ([`crate::link::LEASE`]); otherwise for [`crate::drive::REFERENCE_TIMEOUT_TICKS`].
        hold: bool,
    },
}

/// A sample and its tick, counted from 0 when the mode was set.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Numbered {
    /// The tick's number.
    pub tick: u32,
    /// What the tick gave.
    pub sample: Sample,
}

/// References that may wait for their ticks: 128 ms of them, and 256 at least.
const WAITING: usize = if ticks_in(128) < 256 { 256 } else { ticks_in(128) as usize };

/// Most elements of an ended mode that are discarded in a tick: a full queue of references at once would take longer
/// than a tick of 10 kHz has.
const DISCARDED: usize = 32;

/// The tick's end of a queue whose elements are for the mode in which they came.
pub struct Inbox<'q, T> {
    queue: Consumer<'q, T>,
    /// How many are still of the modes before.
    stale: usize,
}

impl<'q, T> Inbox<'q, T> {
    fn new(queue: Consumer<'q, T>) -> Self {
        Self { queue, stale: 0 }
    }

    /// What waits now is for the mode that ends: it will be [discarded](Self::discard).
    pub fn change_mode(&mut self) {
        self.stale = self.queue.len();
    }

    /// A tick's part of what is to be discarded.
    #[inline]
    pub fn discard(&mut self) {
        if self.stale > 0 {
            self.discard_some();
        }
    }

    /// (A function of its own: most ticks do without it.)
    #[cold]
    #[inline(never)]
    fn discard_some(&mut self) {
        for _ in 0..self.stale.min(DISCARDED) {
            _ = self.queue.dequeue();
            self.stale -= 1;
        }
    }

    /// The next element for this mode, as soon as none for another waits before it.
    pub fn take(&mut self) -> Option<T> {
        if self.stale > 0 { None } else { self.queue.dequeue() }
    }
}

/// The queues themselves. Each holds one element less than its length.
#[derive(Debug)]
pub struct Queues {
    commands: Queue<Command, 4>,
    fed: Queue<AdcCode, 256>,
    references: Queue<f32, WAITING>,
    samples: Queue<Numbered, 256>,
}

/// The tick's ends of the queues.
pub struct TickQueues<'q> {
    /// From the link; one a tick is taken.
    pub commands: Consumer<'q, Command>,
    /// From the link, in [`Mode::Pil`]; one a tick is taken.
    pub fed: Inbox<'q, AdcCode>,
    /// From the link, µm in [`Mode::Follow`], V in [`Mode::Excite`]; one a tick is taken.
    pub references: Inbox<'q, f32>,
    /// To the link, while it streams.
    pub samples: Producer<'q, Numbered>,
}

/// The link's ends of the queues.
pub struct LinkQueues<'q> {
    /// Commands on their way to the tick.
    pub commands: Producer<'q, Command>,
    /// To the tick, in [`Mode::Pil`].
    pub fed: Producer<'q, AdcCode>,
    /// To the tick, µm in [`Mode::Follow`], V in [`Mode::Excite`].
    pub references: Producer<'q, f32>,
    /// From the tick, while it streams.
    pub samples: Consumer<'q, Numbered>,
}

impl Queues {
    /// Queues with nothing in them.
    pub const fn new() -> Self {
        Self { commands: Queue::new(), fed: Queue::new(), references: Queue::new(), samples: Queue::new() }
    }

    /// Both ends of every queue.
    pub fn split(&mut self) -> (TickQueues<'_>, LinkQueues<'_>) {
        let (to_tick, commands) = self.commands.split();
        let (feed, fed) = self.fed.split();
        let (refer, references) = self.references.split();
        let (to_link, samples) = self.samples.split();
        (
            TickQueues { commands, fed: Inbox::new(fed), references: Inbox::new(references), samples: to_link },
            LinkQueues { commands: to_tick, fed: feed, references: refer, samples },
        )
    }
}

impl Default for Queues {
    fn default() -> Self {
        Self::new()
    }
}
