//! The DAC's output, sixteen times as fine as its codes. TIM7 puts a code out every 10 µs, whatever the tick's rate;
//! DMA brings the codes from a ring; their mean is what the tick wants ([`firmware::shaping`]). A low-pass behind the
//! pin shows the mean.
//!
//! **The ring** has two halves, one tick's codes each: the tick fills the half that is not being played. DMA fetches
//! a code by one TIM7 trigger, and the next puts it out; so TIM7 starts two triggers ahead of TIM6, and a tick's codes
//! begin less than a microsecond before the next TIM6 trigger. A tick must be done 20 µs before that trigger: one
//! that is later leaves the ring as it is.
//!
//! **A missed tick** repeats the last two ticks' codes: the output goes back by one tick's change, and forth again. A
//! drive then goes on from what the pin shows, at its slew rate, wherever the tick's command is meanwhile.

use core::ptr::addr_of_mut;
use core::sync::atomic::{Ordering::SeqCst, compiler_fence};

use embassy_stm32::dac::{Ch1, DacChannel, Dma, Mode, Value};
use embassy_stm32::dma::{Channel, TransferOptions};
use embassy_stm32::mode::Async;
use embassy_stm32::pac;
use embassy_stm32::peripherals::{DAC1, DMA1_CH2, TIM7};
use embassy_stm32::timer::low_level::Timer;
use embassy_stm32::triggers::TIM7_TRGO;
use embassy_stm32::{Peri, bind_interrupts, dma};
use firmware::ramp::Slewed;
use firmware::rate::TICK_HZ;
use firmware::shaping::{DacParts, PARTS, Shaper};

use super::clocks::{self, CORE_HZ};
use super::shared::TELEMETRY;
use super::trigger;

bind_interrupts!(struct Irqs {
    DMA1_CHANNEL2 => dma::InterruptHandler<DMA1_CH2>;
});

/// Codes a second.
const CODES_HZ: u32 = 100_000;
/// Codes a tick; 50 at 2 kHz.
const CODES: u32 = CODES_HZ / TICK_HZ;
/// Codes of the ring: two ticks'.
const RING_CODES: u32 = 2 * CODES;
/// Words of half the ring, two codes each.
const HALF: usize = CODES as usize / 2;
/// Codes that DMA has fetched when a tick's first one goes out: that and the next.
const FETCHED_AHEAD: u32 = 2;
/// By so many codes, either way, what DMA has fetched may be beside what TIM6 has counted.
const SLACK: u32 = 1;
/// A tick's codes begin at most so many cycles before TIM6's trigger.
const LEAD: u32 = CORE_HZ / 1_000_000;
/// A tick must be done so many cycles before the next trigger: before the first of its codes is fetched, and a
/// code's time more.
pub const AHEAD: u32 = 2 * (CORE_HZ / CODES_HZ) + LEAD;
/// Parts of a code that rounding and the supply's correction may add to the way that the slew rate has left.
const ROUNDING: u16 = 4;
/// DMA1's channel, from 0.
const CHANNEL: usize = 1;

static mut RING: [u32; 2 * HALF] = [0; 2 * HALF];

/// What puts the output out.
pub struct Output {
    shaper: Shaper,
    /// What the halves of the ring are filled with.
    filled: [Slewed; 2],
    /// Counts of TIM6 from trigger to trigger.
    turn: u32,
    /// Dropped, it would stop.
    _dac: DacChannel<'static, Async>,
}

/// What has become of a tick's output.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Put {
    /// It goes out from the next trigger on.
    InTime,
    /// DMA is about to fetch the next codes: they are left as they are, those of the tick before the last.
    TooLate,
    /// DMA has stopped, or is out of step with the ticks.
    Stopped,
}

/// TIM7, which does not run yet.
pub struct Ahead(Timer<'static, TIM7>);

impl Ahead {
    /// Starts it; it is two triggers ahead of what is started at once, before any interrupt.
    pub fn start(self) {
        self.0.start();
        while RING_CODES - u32::from(left()) < FETCHED_AHEAD {}
        // Dropped, it would stop.
        core::mem::forget(self.0);
    }
}

/// The DAC on its pin, at what it is given for its safe code until TIM7 is started; without the pin, where nobody knows
/// which that is: resistors hold what is wired to it then, as in a reset.
pub fn start(dac1: Peri<'static, DAC1>, dma: Peri<'static, DMA1_CH2>, tim7: Peri<'static, TIM7>) -> (Output, Ahead) {
    // Before the DAC listens: loading the prescaler is a trigger too.
    let timer = trigger::at_rate(tim7, CODES_HZ);
    let request = Dma::<DAC1, Ch1>::request(&*dma);
    // SAFETY: the driver is given the channel, too, and never writes by it.
    let ours = unsafe { dma.clone_unchecked() };
    // The pin, analogue since reset, stays high-impedance until the output register holds the safe code: the driver
    // switches a channel on before it can be given a code, so this one starts without the pin.
    let mut dac = DacChannel::new_triggered_internal::<_, Ch1, _>(dac1, dma, TIM7_TRGO, Irqs);
    let given = TELEMETRY.safe_given();
    let safe = || Value::Bit12Right(nearest(given));
    dac.set(safe());
    if TELEMETRY.connected() {
        dac.set_mode(Mode::NormalExternalBuffered);
    }
    clocks::tell_dac();
    dac.enable();
    // Once more, for a DAC that loads its output register when a code is written and at no other time.
    dac.set(safe());
    let mut shaper = Shaper::new();
    fill(&mut shaper, given, 0);
    fill(&mut shaper, given, 1);
    let mut options = TransferOptions::default();
    (options.circular, options.complete_transfer_ir) = (true, false);
    let mut channel = Channel::new(ours, Irqs);
    // SAFETY: the ring is the channel's and `fill`'s for ever. A half-word becomes a word on its way: the register
    // takes no less.
    let transfer = unsafe {
        let codes = core::ptr::slice_from_raw_parts(addr_of_mut!(RING).cast::<u16>(), 4 * HALF);
        channel.write_raw(request, codes, pac::DAC1.dhr12r(0).as_ptr().cast::<u32>(), options)
    };
    // Dropped, it would stop.
    core::mem::forget(transfer);
    pac::DAC1.cr().modify(|w| w.set_dmaen(0, true));
    // The constructor chooses the trigger and leaves it off.
    dac.set_triggering(true);
    let turn = u32::from(pac::TIM6.arr().read().arr()) + 1;
    (Output { shaper, filled: [Slewed::at(given); 2], turn, _dac: dac }, Ahead(timer))
}

impl Output {
    /// Puts a tick's output out from the next trigger on.
    #[inline]
    pub fn put(&mut self, given: DacParts) -> Put {
        // One that stands still may stand in phase. (That it has turned since the last tick says less: one that is late
        // may be done a turn before the next.)
        let runs = pac::TIM7.cr1().read().cen();
        // Codes of the tick that are over.
        let over = u32::from(pac::TIM6.cnt().read().cnt()) * CODES / self.turn;
        let fetched = RING_CODES - u32::from(left());
        // Where in the ring the tick's codes began: at the start of a half, to within the slack, which is added so that
        // neither side of it lies in the half before; a turn more, so that nothing is below 0.
        let began = RING_CODES + fetched + SLACK - FETCHED_AHEAD - over;
        let in_phase = began % CODES <= 2 * SLACK;
        // The half that is being put out; the other is filled, unless it is about to be fetched.
        let now = (began / CODES % 2) as usize;
        let in_time = over < CODES - FETCHED_AHEAD;
        if in_time {
            // From what is being put out, which a tick that was too late may have left behind.
            let mut next = self.filled[now];
            fill(&mut self.shaper, next.step(given, TELEMETRY.stride_given(), ROUNDING), 1 - now);
            self.filled[1 - now] = next;
        }
        match runs && in_phase && !pac::DAC1.sr().read().dmaudr(0) {
            false => Put::Stopped,
            true if in_time => Put::InTime,
            true => Put::TooLate,
        }
    }
}

/// Fills a half of the ring, the first or the second.
#[inline]
fn fill(shaper: &mut Shaper, given: DacParts, which: usize) {
    // SAFETY: a half of the ring, which DMA does not read now, and the core nowhere else.
    let half = unsafe { &mut *addr_of_mut!(RING).cast::<[u32; HALF]>().add(which) };
    shaper.fill(given, half);
    // It is in memory long before DMA comes for it, as long as the compiler leaves it here.
    compiler_fence(SeqCst);
}

/// What DMA has left to fetch until the ring begins anew.
fn left() -> u16 {
    pac::DMA1.ch(CHANNEL).ndtr().read().ndt()
}

/// The code that is nearest to what the DAC is given.
fn nearest(DacParts(parts): DacParts) -> u16 {
    // The largest has no parts.
    (parts + PARTS / 2) / PARTS
}

/// Without the tick, which must not come any more: leaves the pin as it is, and says what that is; `None` where the DAC
/// does not run.
pub fn hold() -> Option<DacParts> {
    // Before the DAC runs the registers have no clock, and read as 0.
    if !pac::DAC1.cr().read().en(0) {
        return None;
    }
    pac::DMA1.ch(CHANNEL).cr().modify(|w| w.set_en(false));
    pac::DAC1.cr().modify(|w| w.set_dmaen(0, false));
    let shown = pac::DAC1.dor(0).read().dor();
    Some(DacParts(shown * PARTS))
}

/// After [`hold`]: puts this out at once.
pub fn put_at_once(given: DacParts) {
    let code = nearest(given);
    pac::DAC1.dhr12r(0).write(|w| w.set_dhr(code));
    pac::DAC1.cr().modify(|w| w.set_ten(0, false));
    // Once more: only what is written while no trigger is waited for is sure to go out.
    pac::DAC1.dhr12r(0).write(|w| w.set_dhr(code));
}
