//! The firmware, run step by step: a line of bytes, a tick at each of its waits, and a converter that reads what it
//! is told to.

use crate::torn_flash::{Chip, Flash, PAGE};
use embassy_time::Duration;
use embedded_io_async::{ErrorType, Read, Write};
use estimator_core::table::Interface;
use estimator_core::{AdcCode, Admitted, DacCode, DriveCalibration, DriveLimits, Range, SetpointCalibration, Table};
use firmware::drive::Drive;
use firmware::panel::Front;
use firmware::restarts::{Memory, Place, Restarts};
use firmware::waveform::Points;
use firmware::{Conversion, Facts, Peripherals, Resources, Telemetry, Tick, run};
use parameter_store::StoreError;
use protocol::ResetCause;
use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::convert::Infallible;
use std::future::{Future, poll_fn};
use std::pin::{Pin, pin};
use std::task::{Context, Poll, Waker};

/// Cycles from tick to tick.
const PERIOD: u32 = 85_000;
/// What passes at each of the firmware's waits, and how many of them it may make in a row: two seconds.
const PACE: Duration = Duration::from_micros(100);
const WAITS: usize = 20_000;

const FACTS: Facts = Facts {
    name: "fuzzed",
    emulated: true,
    uid: None,
    has_setpoint: true,
    has_trigger: true,
    interface: Interface { tick_us: 500, adc_full_scale: 65_520, dac_full_scale: 4095 },
    dac_parts: 1,
    cycles_per_tick: PERIOD,
    reset: ResetCause::empty(),
    restarts: Restarts::NONE,
    supply_mv: None,
    brown_out_level: None,
    clock_good: true,
    no_store: None,
};

/// It measures and counts nothing.
struct Bare;

impl firmware::Chip for Bare {}

/// Tables that the device can run: the compiled one, one that drives an amplifier of 0 … 4 V, and one that follows a
/// set-point from its start on.
pub fn tables() -> [Admitted; 3] {
    let limits = DriveLimits { range_v: Range { min: 0.0, max: 3.6 }, rest_v: 0.5, slew_v_per_s: 40.0 };
    let drive = DriveCalibration { gain_codes_per_v: 4095.0 / 4.0, offset_code: 0.0, limits, setpoint: None };
    let setpoint = SetpointCalibration { gain_um_per_code: 50.0 / 65_520.0, offset_um: -5.0, at_start: true };
    let compiled = firmware::compiled::TABLE;
    let drives = [None, Some(drive), Some(DriveCalibration { setpoint: Some(setpoint), ..drive })];
    drives.map(|drive| Table { drive, ..compiled }.admit().expect("the Voigt family has an inverse"))
}

/// Both ends of the line, and the button.
#[derive(Default)]
struct Line {
    to_device: RefCell<VecDeque<u8>>,
    from_device: RefCell<Vec<u8>>,
    /// The device waits for bytes, and there are none.
    quiet: Cell<bool>,
    button: Cell<bool>,
}

/// A running device.
pub struct Device<'r, 'q> {
    line: &'r Line,
    run: Pin<&'r mut (dyn Future<Output = Result<(), StoreError>> + 'r)>,
    tick: &'r RefCell<Option<Tick<'q>>>,
    telemetry: &'r Telemetry,
    table: &'r Admitted,
    advance: &'r dyn Fn(Duration),
    ended: bool,
    /// What the converter reads: the amplifier, where that is not said.
    pub monitor: Option<u16>,
    pub setpoint: Option<u16>,
    ticks: u32,
    cycles: u32,
    dac: DacCode,
}

/// Has a device live that boots with this table.
pub fn live(
    chip: &RefCell<Chip>,
    table: &Admitted,
    advance: &dyn Fn(Duration),
    life: impl FnOnce(&mut Device<'_, '_>),
) {
    let (line, telemetry, points) = (Line::default(), Telemetry::new(), Points::new());
    let mut resources = Resources::new();
    let kept = Place::default();
    let tick = RefCell::new(None);
    let board = Peripherals {
        facts: FACTS,
        chip: Bare,
        memory: Memory::new(&kept),
        last_words: None,
        receiver: &line,
        transmitter: &line,
        flash: Flash(chip),
        pages: 0..2 * PAGE as u32,
        front: &line,
        start: |ready| *tick.borrow_mut() = Some(ready),
    };
    let mut run = pin!(run(board, &mut resources, &points, &telemetry));
    let mut device = Device {
        line: &line,
        run: run.as_mut(),
        tick: &tick,
        telemetry: &telemetry,
        table,
        advance,
        ended: false,
        monitor: None,
        setpoint: None,
        ticks: 0,
        cycles: 0,
        dac: DacCode(0),
    };
    device.settle();
    life(&mut device);
}

impl Device<'_, '_> {
    /// Sends it bytes; returns what it sends until it waits for more.
    pub fn send(&mut self, bytes: &[u8]) -> Vec<u8> {
        self.line.to_device.borrow_mut().extend(bytes);
        self.settle();
        self.line.from_device.take()
    }

    /// Whether it has ended, to be started again.
    pub fn ended(&self) -> bool {
        self.ended
    }

    /// Whether its output, which drives, is not at rest.
    pub fn drives(&self) -> bool {
        self.telemetry.drives() && self.dac != self.telemetry.safe()
    }

    /// Holds the button down, or lets it go.
    pub fn press(&self, held: bool) {
        self.line.button.set(held);
    }

    /// Lets time pass, and a few ticks.
    pub fn wait(&mut self, time: Duration) {
        for _ in 0..8 {
            (self.advance)(time / 8);
            self.tick(false);
            self.settle();
        }
    }

    /// One tick, whose trigger may be late by one.
    pub fn tick(&mut self, late: bool) {
        let mut slot = self.tick.borrow_mut();
        let Some(tick) = slot.as_mut() else { return };
        if self.ticks == 0 {
            self.dac = self.telemetry.safe();
        }
        self.ticks = self.ticks.wrapping_add(1);
        self.cycles = self.cycles.wrapping_add(if late { 2 * PERIOD } else { PERIOD });
        let noise = (self.ticks % 2) as u16;
        let monitor = self.monitor.unwrap_or_else(|| {
            // What an amplifier does that goes where the DAC stands, or a triangle.
            let triangle = 2_000 + 30 * (self.ticks % 2_000).min(2_000 - self.ticks % 2_000) as u16;
            self.table.drive.map_or(triangle, |drive| self.table.adc.code(drive.voltage::<f32>(self.dac)).0)
        });
        let setpoint = self.setpoint.map(|code| AdcCode(code.wrapping_add(noise)));
        let monitor = AdcCode(if self.monitor.is_some() { monitor } else { monitor + noise });
        if tick.sync().is_some() {
            tick.trigger(self.ticks.is_multiple_of(7));
        }
        // A part is a code here.
        let dac = DacCode(tick.sample(Conversion { monitor, sensor: None, setpoint }, self.cycles).0);
        assert!(dac.0 <= FACTS.interface.dac_full_scale);
        if let Some(stride) = Drive::stride(self.table) {
            let step = dac.0.abs_diff(self.dac.0);
            // Both codes are rounded.
            assert!(u32::from(step) <= stride.get().div_ceil(1 << 16), "the output jumps by {step} codes");
        }
        self.dac = dac;
    }

    /// Runs it until it waits for bytes, or has ended.
    fn settle(&mut self) {
        if self.ended {
            return;
        }
        let mut context = Context::from_waker(Waker::noop());
        for _ in 0..WAITS {
            self.line.quiet.set(false);
            if let Poll::Ready(end) = self.run.as_mut().poll(&mut context) {
                end.expect("the pages fit");
                assert_eq!(self.telemetry.ticks_to_safe(), 0, "it starts again while its output is not at rest");
                self.ended = true;
                return;
            }
            if self.line.quiet.get() {
                return;
            }
            self.tick(false);
            (self.advance)(PACE);
        }
        panic!("it does not wait for the line any more");
    }
}

impl ErrorType for &Line {
    type Error = Infallible;
}

impl Read for &Line {
    async fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Infallible> {
        poll_fn(|_| {
            let mut waiting = self.to_device.borrow_mut();
            let length = waiting.len().min(bytes.len());
            if length == 0 {
                self.quiet.set(true);
                return Poll::Pending;
            }
            for (place, byte) in bytes.iter_mut().zip(waiting.drain(..length)) {
                *place = byte;
            }
            Poll::Ready(Ok(length))
        })
        .await
    }
}

impl Write for &Line {
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        self.from_device.borrow_mut().extend(bytes);
        Ok(bytes.len())
    }

    async fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

impl Front for &Line {
    fn held(&mut self) -> bool {
        self.button.get()
    }

    fn light(&mut self, _: bool) {}
}
