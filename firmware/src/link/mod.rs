//! The serial link: answers requests one at a time and carries samples away.
//!
//! It never delays a tick. What it cannot carry away in time stays in the queue; what finds the queue full is dropped
//! by the tick and counted, and the gap shows in the samples' numbers.

mod device;
mod loaded;
mod report;
mod told;
mod waveform;

pub use device::{Device, LinkEnd};

use crate::panel::{Front, Panel};
use crate::rate::STREAM_EVERY;
use core::num::NonZeroU8;
use core::ops::ControlFlow;
use core::sync::atomic::Ordering::Relaxed;
use embassy_futures::select::{Either, select};
use embassy_futures::yield_now;
use embassy_time::{Duration, Instant, Timer};
use embedded_io_async::{Read, Write};
use embedded_storage_async::nor_flash::NorFlash;
use protocol::frame::MAX_FRAME;
use protocol::sample::MAX_BATCH;
use protocol::{Deframer, FrameError, Mode, Refusal, Reply, Request, Samples, ToDevice, ToHost, encode};

/// Longest wait before samples are sent: four to ten of them.
const PACE: Duration = Duration::from_millis(4);
/// How long a mode that the host has set lasts without a word from it. Some last for ever ([`Mode::lasts`]), and so
/// does [`Mode::Follow`] while it holds a displacement that is to be held for ever.
pub const LEASE: Duration = Duration::from_secs(5);
/// Bytes that are taken from the line at once. Each time samples, panel, lease and timer are looked at, too: with 64
/// bytes that was so often that a line without pauses brought more than was read, where a drive leaves the link a third
/// of the time.
const AT_ONCE: usize = 256;
/// What the reply to a reset, a short one, needs at most to leave the serial line's own buffers.
const DRAIN: Duration = Duration::from_millis(10);

/// The link over a serial line.
pub struct Link<'q, R, W, F: NorFlash, P> {
    device: Device<'q, F>,
    receiver: R,
    transmitter: W,
    panel: Panel<P>,
    deframer: Deframer,
    /// When the last sound frame came.
    heard: Instant,
    frame: [u8; MAX_FRAME],
}

impl<'q, R: Read, W: Write, F: NorFlash, P: Front> Link<'q, R, W, F, P> {
    /// A link for a device, which has its panel's button obeyed, too.
    pub fn new(device: Device<'q, F>, receiver: R, transmitter: W, panel: Panel<P>) -> Self {
        Self {
            device,
            receiver,
            transmitter,
            panel,
            deframer: Deframer::new(),
            heard: Instant::now(),
            frame: [0; MAX_FRAME],
        }
    }

    /// Serves it until it is asked to restart the device.
    pub async fn serve(mut self) {
        let mut bytes = [0; AT_ONCE];
        loop {
            match select(self.receiver.read(&mut bytes), Timer::after(PACE)).await {
                Either::First(Ok(length)) => {
                    if self.take(&bytes[..length.min(AT_ONCE)]).await.is_break() {
                        return;
                    }
                }
                Either::First(Err(_)) => self.device.line_errors = self.device.line_errors.wrapping_add(1),
                Either::Second(()) => {}
            }
            self.carry().await;
            self.attend().await;
            self.expire().await;
            // A sender that never pauses must not keep the watchdog's keeper waiting.
            yield_now().await;
        }
    }

    /// Answers what is in these bytes; breaks off after a request to restart.
    async fn take(&mut self, bytes: &[u8]) -> ControlFlow<()> {
        for &byte in bytes {
            match self.deframer.push::<ToDevice>(byte) {
                None => {}
                Some(Err(error)) => {
                    self.device.frames_refused = self.device.frames_refused.wrapping_add(1);
                    if matches!(error, FrameError::Version { .. }) {
                        // Whoever asked learns from this frame's version which one is spoken here.
                        self.send(&ToHost::Reply { to: 0, reply: Reply::Refused(Refusal::Version) }).await;
                    }
                }
                Some(Ok(ToDevice { sequence, request })) => {
                    self.heard = Instant::now();
                    let reset = request == Request::Reset;
                    let reply = self.device.handle(request).await;
                    self.send(&ToHost::Reply { to: sequence, reply }).await;
                    if reset {
                        self.device.rest().await;
                        // The code is the pin's a tick later, which is sooner than this.
                        Timer::after(DRAIN).await;
                        return ControlFlow::Break(());
                    }
                }
            }
        }
        ControlFlow::Continue(())
    }

    /// Obeys the button and has the lamp say how the device is.
    async fn attend(&mut self) {
        let now_ms = Instant::now().as_millis();
        if self.panel.pressed(now_ms) && self.device.zero().await.is_ok() {
            self.panel.obeyed(now_ms);
        }
        self.panel.show(now_ms, self.device.telemetry.faults());
    }

    /// Ends the mode of a host that has vanished.
    async fn expire(&mut self) {
        if self.device.lent() && self.heard.elapsed() > LEASE && self.device.set_mode(Mode::Estimate).await.is_ok() {
            self.heard = Instant::now();
        }
    }

    /// Sends the samples that wait, and none that comes meanwhile: where the line is slower than they come, the queue
    /// would never be empty, and no request, button or lease be looked at again.
    async fn carry(&mut self) {
        let mut waiting = self.device.queues.samples.len();
        while waiting > 0
            && self.device.telemetry.streaming.load(Relaxed)
            && let Some(samples) = self.batch()
        {
            waiting = waiting.saturating_sub(samples.samples.len());
            self.send(&ToHost::Samples(samples)).await;
        }
    }

    /// The waiting samples without a gap, as many as a frame takes.
    fn batch(&mut self) -> Option<Samples> {
        // A change of mode leaves none waiting.
        let every = if self.device.telemetry.mode() == Mode::Pil { NonZeroU8::MIN } else { STREAM_EVERY };
        let queue = &mut self.device.queues.samples;
        let first = queue.peek()?.tick;
        let mut batch = Samples { first, every, samples: heapless::Vec::new() };
        for tick in (0..MAX_BATCH as u32).map(|k| first.wrapping_add(k * u32::from(every.get()))) {
            if queue.peek().is_none_or(|next| next.tick != tick) {
                break;
            }
            let Some(next) = queue.dequeue() else { break };
            if batch.samples.push(next.sample).is_err() {
                break;
            }
        }
        Some(batch)
    }

    async fn send(&mut self, message: &ToHost) {
        let Some(frame) = encode(message, &mut self.frame) else { return };
        if self.transmitter.write_all(frame).await.is_err() || self.transmitter.flush().await.is_err() {
            self.device.line_errors = self.device.line_errors.wrapping_add(1);
        }
    }
}
