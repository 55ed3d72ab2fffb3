//! A device on the host, beside its tick.

use crate::common::{FACTS, LinkEnd, PERIOD, linearising, record, started, tick, triangle};
use core::sync::atomic::Ordering::Relaxed;
use embassy_futures::block_on;
use estimator_core::{AdcCode, Admitted, DacCode};
use firmware::boot::Chosen;
use firmware::link::Device;
use firmware::restarts::Memory;
use firmware::startup::Startup;
use firmware::supply::Measured;
use firmware::{Chip, Conversion, Tick};
use parameter_store::{ParameterStore, RamFlash};
use protocol::{Faults, Reply, Request, ResetCause, TableSource, text};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU16};

/// Longer than a tick, after which a command is obeyed.
pub const TICKS: std::time::Duration = std::time::Duration::from_millis(20);

pub type Flash = RamFlash<&'static mut [u8]>;

pub fn flash(memory: Vec<u8>) -> ParameterStore<Flash> {
    let pages = 0..memory.len() as u32;
    ParameterStore::new(RamFlash::new(memory.leak()), pages).unwrap()
}

/// A chip that has met errors.
struct TestChip;

impl Chip for TestChip {
    fn flash_errors(&self) -> u32 {
        3
    }

    fn line_errors(&self) -> u32 {
        2
    }
}

/// A device whose ticks run in a thread, ten times as fast as they should, until it is dropped.
pub struct Bench {
    pub device: Device<'static, Flash>,
    pub memory: Memory<'static>,
    stop: Arc<AtomicBool>,
}

impl Drop for Bench {
    fn drop(&mut self) {
        self.stop.store(true, Relaxed);
    }
}

impl Bench {
    pub fn new(table: Option<Admitted>) -> Self {
        Self::of(table, tick(table.as_ref(), Faults::empty()))
    }

    /// A device that has this tick.
    pub fn of(table: Option<Admitted>, tick: (Tick<'static>, LinkEnd)) -> Self {
        Self::with(table, tick, |k, _| triangle(k).into())
    }

    /// A device that follows a set-point from its start on, whose controller gives this code, but for noise, and whose
    /// amplifier does what it is told.
    pub fn controlled(code: Arc<AtomicU16>) -> Self {
        let table = linearising(true);
        let tick = started(Startup::new(Some(&table), &FACTS, Faults::empty()));
        Self::with(Some(table), tick, move |k, dac| {
            let noise = (k % 2) as u16;
            let AdcCode(monitor) = table.adc.code(table.drive.unwrap().voltage::<f32>(dac));
            let setpoint = Some(AdcCode(code.load(Relaxed) + noise));
            Conversion { monitor: AdcCode(monitor + noise), sensor: None, setpoint }
        })
    }

    /// A device whose converter gives this, by the tick's number and what the DAC puts out.
    pub fn with(
        table: Option<Admitted>,
        (mut tick, rest): (Tick<'static>, LinkEnd),
        conversion: impl Fn(u32, DacCode) -> Conversion + Send + 'static,
    ) -> Self {
        rest.telemetry.supply.publish(&Measured::of(FACTS.supply_mv));
        let stop = Arc::new(AtomicBool::new(false));
        let stopped = stop.clone();
        let mut dac = rest.telemetry.safe();
        std::thread::spawn(move || {
            for k in 0.. {
                if stopped.load(Relaxed) {
                    return;
                }
                dac = DacCode(tick.sample(conversion(k, dac), k.wrapping_mul(PERIOD)).0);
                std::thread::sleep(std::time::Duration::from_micros(50));
            }
        });
        Self::beside(table, rest, stop)
    }

    /// A device whose ticks the test runs.
    pub fn still(table: Option<Admitted>, rest: LinkEnd) -> Self {
        Self::beside(table, rest, Arc::default())
    }

    fn beside(table: Option<Admitted>, rest: LinkEnd, stop: Arc<AtomicBool>) -> Self {
        let source = TableSource::Compiled { reason: text("no table is stored") };
        let chosen = Chosen { table, source, doubts: Faults::empty() };
        let memory = Memory::new(Box::leak(Box::default()));
        let (last_words, store) = (Some(text("panicked")), flash(vec![0xFF; 4096]));
        Self { device: Device::new(FACTS, &TestChip, memory, chosen, last_words, store, rest), memory, stop }
    }

    /// Until these faults are there, or these alone where there are none.
    pub fn until(&self, faults: Faults) {
        let started = std::time::Instant::now();
        let now = || self.device.telemetry.faults();
        // Before the first tick nothing is known to be wrong.
        std::thread::sleep(TICKS);
        while if faults.is_empty() { !now().is_empty() } else { !now().contains(faults) } {
            assert!(started.elapsed().as_secs() < 20, "{faults:?} do not come, there are {:?}", now());
            std::thread::sleep(TICKS);
        }
    }

    /// Whether it has been told a displacement; it forgets that.
    pub fn told(&self) -> bool {
        let told = self.memory.count(ResetCause::PIN).told;
        self.memory.asked();
        told
    }

    pub fn ask(&mut self, request: Request) -> Reply {
        block_on(self.device.handle(request))
    }

    pub fn stored(&mut self) -> Option<Vec<u8>> {
        block_on(self.device.store.load()).unwrap().map(<[u8]>::to_vec)
    }
}

pub fn push(table: &Admitted, while_estimating: bool) -> Request {
    Request::Push { record: record(table), while_estimating, rewired: false }
}
