//! The device's end of the page: takes what is streamed, sends the page what it draws, and does what its
//! buttons ask for.
//!
//! A link that fails ends nothing: what was recorded is kept, the page says why, and the device is looked
//! for every second.

use crate::column::Columns;
use crate::datagrams::Datagrams;
use crate::device::Device;
use crate::error::{Gone, Undone, Unkept};
use crate::feed::{Feed, Tick};
use crate::figures::{facts, figures};
use crate::log::Log;
use crate::message::{self, State, Words};
use crate::server::{Asked, Server, Wish};
use device_link::motion::Motion;
use device_link::window::Window;
use device_link::{LinkError, told, words};
use protocol::{Faults, Health, Samples};
use remedy::sentence;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Length of the page's columns, µs.
const COLUMN_US: u32 = 5000;
/// Longest wait for samples before a button is looked at.
const LOOK: Duration = Duration::from_millis(10);
/// How often the page is sent columns.
const COLUMNS: Duration = Duration::from_millis(50);
/// How often it is sent the state.
const STATE: Duration = Duration::from_millis(200);
/// How often the device is asked how it is.
const HEALTH: Duration = Duration::from_secs(2);
/// How often a device that is gone is looked for.
const AGAIN: Duration = Duration::from_secs(1);

/// What outlasts a link.
pub struct Scope<'s> {
    server: &'s Server,
    /// Where recordings go.
    folder: PathBuf,
    datagrams: Option<Datagrams>,
    log: Option<Log>,
    recorded: Option<String>,
    /// Samples lost over the links before.
    lost: u64,
}

/// What there is at the end.
pub struct Ended {
    /// The device, unless its link had failed.
    pub device: Option<Device>,
    /// What became of the recording that was under way, if one was: a sentence, an error where it is not all there.
    pub recorded: Option<Result<String, Unkept>>,
}

impl<'s> Scope<'s> {
    /// A scope on this server's page, which records into a folder and sends the same samples elsewhere, too, where
    /// that is wanted.
    pub fn new(server: &'s Server, folder: &Path, datagrams: Option<Datagrams>) -> Self {
        // Named whole, so that who reads the page finds it. Where the operating system knows of no folder, it will
        // say so itself.
        let folder = std::path::absolute(folder).unwrap_or(folder.to_owned());
        Self { server, folder, datagrams, log: None, recorded: None, lost: 0 }
    }

    /// Writes the next frame; a recording that it ends is kept.
    fn write(&mut self, samples: &Samples) {
        let Some(log) = &mut self.log else { return };
        match log.take(samples) {
            Ok(None) => {}
            Ok(Some(why)) => drop(self.end_log(Some(&why))),
            Err(error) => drop(self.end_log(Some(&error.to_string()))),
        }
    }

    /// Ends the recording that is under way, if one is; says so on the page, and here, an error where it is
    /// not all there.
    fn end_log(&mut self, why: Option<&str>) -> Option<Result<String, Unkept>> {
        let finished = self.log.take()?.finish();
        let kept = finished.as_ref().map_or_else(Unkept::to_string, String::clone);
        self.recorded = Some(why.map_or_else(|| kept.clone(), |why| format!("{why}; {kept}")));
        Some(finished)
    }

    fn begin_log(&mut self, device: &Device) -> Result<String, Undone> {
        if let Some(log) = &self.log {
            return Err(Undone::Recording { path: log.path().to_owned() });
        }
        let log = Log::begin(&self.folder, device.recording())
            .map_err(|error| Undone::NoRecording { folder: self.folder.clone(), error })?;
        let said = format!("recording into {}", log.path().display());
        (self.log, self.recorded) = (Some(log), None);
        Ok(said)
    }

    fn send<T: serde::Serialize>(&self, name: &'static str, message: &T) {
        // Cannot fail: the messages are numbers and words.
        let json = serde_json::to_string(message).expect("a message is JSON");
        match name {
            "device" => self.server.subscribers().begin(name, &json),
            "columns" => self.server.subscribers().send(name, &json),
            _ => self.server.subscribers().send_state(name, &json),
        }
    }
}

/// Shows a device until it is `over`, and hands it back; where its link fails, the next that `reopen` finds, and none
/// where it finds none by then.
pub fn run(
    device: Device,
    scope: &mut Scope<'_>,
    reopen: &mut dyn FnMut() -> Result<Device, Gone>,
    over: &dyn Fn() -> bool,
) -> Ended {
    let mut found = Ok(device);
    let device = loop {
        match found {
            Ok(device) => match Link::new(device, scope).and_then(|link| link.run(scope, over)) {
                Ok(device) => break Some(device),
                Err(error) => {
                    scope.end_log(Some("the link failed"));
                    found = Err(Gone(sentence(&error)));
                }
            },
            Err(why) => {
                if !wait(scope, &why, over) {
                    break None;
                }
                found = reopen();
            }
        }
    };
    Ended { device, recorded: scope.end_log(None) }
}

/// Says why there is nothing to be seen, for a second; `false` when it is over.
fn wait(scope: &Scope<'_>, why: &Gone, over: &dyn Fn() -> bool) -> bool {
    let state = State { gone: Some(why.to_string()), recorded: scope.recorded.clone(), ..State::default() };
    scope.send("state", &state);
    let until = Instant::now() + AGAIN;
    while Instant::now() < until {
        if over() {
            return false;
        }
        std::thread::sleep(LOOK);
        if let Some(asked) = scope.server.asked() {
            asked.answer(Err(why.clone().into()));
        }
    }
    true
}

/// A link that is up.
struct Link {
    device: Device,
    feed: Feed,
    columns: Columns,
    pending: message::Columns,
    window: Window,
    /// The last tick, where the last second has one.
    last: Option<Tick>,
    health: Health,
    rate: f64,
}

impl Link {
    fn new(mut device: Device, scope: &mut Scope<'_>) -> Result<Self, LinkError> {
        let health = device.client.health()?;
        device.client.stream(true)?;
        if let Some(datagrams) = &mut scope.datagrams {
            datagrams.restart(device.feed());
        }
        let length = device.ticks_in(COLUMN_US);
        scope.send("device", &facts(&device, length));
        Ok(Self {
            feed: device.feed(),
            columns: Columns::new(length),
            pending: message::Columns::default(),
            window: device.window(),
            last: None,
            health,
            rate: 0.0,
            device,
        })
    }

    /// Shows the device until it is over, and hands it back.
    fn run(mut self, scope: &mut Scope<'_>, over: &dyn Fn() -> bool) -> Result<Device, LinkError> {
        let shown = self.show(scope, over);
        scope.lost += self.window.lost();
        shown.map(|()| self.device)
    }

    fn show(&mut self, scope: &mut Scope<'_>, over: &dyn Fn() -> bool) -> Result<(), LinkError> {
        let start = Instant::now();
        let (mut columns, mut state, mut health) = (start, start, start);
        let (mut second, mut before) = (start, 0);
        while !over() {
            if let Some(samples) = self.device.client.samples(LOOK)? {
                self.take(&samples, scope);
            }
            if let Some(asked) = scope.server.asked() {
                self.obey(asked, scope);
                // What it has done is seen at once.
                state = start;
            }
            if let Some(why) = scope.log.as_ref().and_then(Log::silence) {
                scope.end_log(Some(&why));
            }
            if columns.elapsed() >= COLUMNS && !self.pending.columns.is_empty() {
                scope.send("columns", &std::mem::take(&mut self.pending));
                columns = Instant::now();
            }
            if second.elapsed().as_secs_f64() >= 1.0 {
                let received = self.window.received();
                self.rate = (received - before) as f64 / second.elapsed().as_secs_f64();
                (second, before) = (Instant::now(), received);
                if self.rate == 0.0 {
                    self.window.clear();
                    self.last = None;
                }
            }
            if health.elapsed() >= HEALTH {
                self.health = self.device.client.health()?;
                // One that was restarted streams to nobody.
                if self.rate == 0.0 {
                    self.device.client.stream(true)?;
                }
                health = Instant::now();
            }
            if state.elapsed() >= STATE || state == start {
                scope.send("state", &self.state(scope));
                state = Instant::now();
            }
        }
        self.device.client.stream(false)
    }

    fn take(&mut self, samples: &Samples, scope: &mut Scope<'_>) {
        let Self { feed, columns, pending, window, last, .. } = self;
        window.take(samples);
        feed.take(samples, |tick| {
            *last = Some(*tick);
            if let Some(column) = columns.take(tick) {
                pending.push(&column);
            }
        });
        scope.write(samples);
        if let Some(datagrams) = &mut scope.datagrams {
            datagrams.take(samples);
        }
    }

    fn obey(&mut self, asked: Asked, scope: &mut Scope<'_>) {
        let done = match asked.wish {
            Wish::Zero(at) => self.zero(at),
            Wish::Record(true) => scope.begin_log(&self.device),
            Wish::Record(false) => {
                let before = scope.recorded.clone().unwrap_or("nothing is being recorded".to_owned());
                scope.end_log(None).unwrap_or(Ok(before)).map_err(Undone::from)
            }
        };
        asked.answer(done);
    }

    /// Calls the displacement of now `at`, µm; says what that is worth where the voltage moves.
    fn zero(&mut self, at: f64) -> Result<String, Undone> {
        bench::require_model(&self.device.table)?;
        let before = self.device.client.health()?;
        if let Some(why) = remedy::not_estimating(before.mode, self.device.client.address()) {
            return Err(Undone::NotEstimating(why));
        }
        let motion = Motion::within(&self.window, &self.device.table);
        self.health = told::zero(&mut self.device.client, at as f32)?;
        let moving = remedy::moving(&motion, at).map_or(String::new(), |moving| format!("; careful: {moving}"));
        Ok(format!("called {at} µm; {}{moving}", self.bias()))
    }

    fn bias(&self) -> String {
        words::bias(&self.health, self.device.identity.tick_us)
    }

    fn state(&self, scope: &Scope<'_>) -> State {
        let faults = self.window.faults();
        let rests = self.device.table.drive.is_some() && words::rests(self.health.mode, faults);
        let faults = if rests { Faults::empty() } else { faults };
        let faults = remedy::faults(faults).map(|meaning| (meaning, true));
        let status = remedy::status(self.window.status()).map(|meaning| (meaning, false));
        State {
            gone: None,
            rate: self.rate,
            every: self.window.every().get(),
            lost: scope.lost + self.window.lost(),
            words: faults
                .chain(status)
                .map(|(meaning, fault)| Words { what: meaning.what, remedy: meaning.remedy, fault })
                .collect(),
            mode: words::state(&self.health).to_owned(),
            bias: self.bias(),
            recording: scope
                .log
                .as_ref()
                .map(|log| message::Recording { file: log.path().display().to_string(), seconds: log.seconds() }),
            recorded: scope.recorded.clone(),
            ..figures(&self.window, self.last.as_ref())
        }
    }
}
