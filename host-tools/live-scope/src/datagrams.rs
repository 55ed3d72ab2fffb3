//! Ticks as UDP datagrams, for programs that plot what they receive.
//!
//! | format | what is described where | a datagram |
//! |---|---|---|
//! | [`Format::Teleplot`] | <https://github.com/nesnes/teleplot#telemetry-format> (its port is 47269) | a column: a line `name:ms:value;ms:value§unit` a quantity |
//! | [`Format::PlotJuggler`] | <https://github.com/facontidavide/PlotJuggler>, UDP Server with the protocol JSON, "timestamp" as the time's field (its port is 9870) | a tick: `{"timestamp": s, "piezo": {…}}` |
//!
//! Of a column those ticks are sent at which a quantity is least or largest ([`Columns`]), each with its own time: a
//! glitch of one tick is among them. Times are this machine's when the first tick came, and the device's from then on.

use crate::column::{Column, Columns};
use crate::feed::{Feed, Tick};
use protocol::Samples;
use serde_json::json;
use std::io;
use std::net::{Ipv4Addr, Ipv6Addr, SocketAddr, ToSocketAddrs, UdpSocket};
use std::time::{SystemTime, UNIX_EPOCH};

/// What the lines are for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Format {
    /// Lines as Teleplot reads them.
    Teleplot,
    /// JSON objects as PlotJuggler reads them.
    PlotJuggler,
}

/// Nothing can be sent there.
#[derive(Debug, thiserror::Error)]
#[error("{address}: no address of this network that datagrams can be sent to, as 127.0.0.1:47269")]
pub struct UnknownReceiver {
    /// As it was given.
    pub address: String,
    /// What the operating system says.
    #[source]
    pub source: io::Error,
}

/// Sends what a device streams.
pub struct Datagrams {
    socket: UdpSocket,
    to: SocketAddr,
    format: Format,
    feed: Feed,
    /// Ticks of a column.
    length: u32,
    columns: Columns,
    /// This machine's time at the first tick, s since 1970.
    start: Option<f64>,
}

/// A quantity: its name, its unit, and what a tick has of it.
type Quantity = (&'static str, &'static str, fn(&Tick) -> Option<f32>);

const QUANTITIES: [Quantity; 4] = [
    ("voltage", "V", |tick| Some(tick.voltage_v)),
    ("displacement", "µm", |tick| Some(tick.displacement_um)),
    ("half_width", "µm", |tick| tick.half_width_um),
    ("sensor", "µm", |tick| tick.sensor_um),
];

impl Datagrams {
    /// Datagrams to a `HOST:PORT`, of columns of so many ticks.
    ///
    /// # Errors
    /// There is no such host, or no socket to be had.
    pub fn to(address: &str, format: Format, length: u32, feed: Feed) -> Result<Self, UnknownReceiver> {
        let unknown = |source| UnknownReceiver { address: address.to_owned(), source };
        let mut found = address.to_socket_addrs().map_err(unknown)?;
        let to = found.next().ok_or_else(|| unknown(io::ErrorKind::NotFound.into()))?;
        let any: SocketAddr =
            if to.is_ipv4() { (Ipv4Addr::UNSPECIFIED, 0).into() } else { (Ipv6Addr::UNSPECIFIED, 0).into() };
        let socket = UdpSocket::bind(any).map_err(unknown)?;
        Ok(Self { socket, to, format, feed, length, columns: Columns::new(length), start: None })
    }

    /// Sends the ticks of a frame.
    pub fn take(&mut self, samples: &Samples) {
        let Self { socket, to, format, feed, columns, start, .. } = self;
        feed.take(samples, |tick| {
            let now = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0.0, |since| since.as_secs_f64());
            let start = *start.get_or_insert(now - tick.seconds);
            let Some(column) = columns.take(tick) else { return };
            for datagram in datagrams(&column, *format, start) {
                // Whether anybody receives it is not known, and not asked.
                let _ = socket.send_to(datagram.as_bytes(), *to);
            }
        });
    }

    /// Takes up another link to the device, whose samples count from anywhere; what is left of a column is not sent.
    pub fn restart(&mut self, feed: Feed) {
        (self.feed, self.columns, self.start) = (feed, Columns::new(self.length), None);
    }
}

/// What is sent of a column, its times from `start` on.
fn datagrams(column: &Column, format: Format, start: f64) -> Vec<String> {
    match format {
        Format::Teleplot => vec![QUANTITIES.iter().filter_map(|of| line(column, start, of)).collect()],
        Format::PlotJuggler => column.extremes.iter().map(|tick| object(tick, start)).collect(),
    }
}

fn line(column: &Column, start: f64, (name, unit, of): &Quantity) -> Option<String> {
    let point = |tick: &Tick| Some(format!("{:.3}:{}", 1e3 * (start + tick.seconds), of(tick)?));
    let points: Vec<String> = column.extremes.iter().filter_map(point).collect();
    (!points.is_empty()).then(|| format!("{name}:{}§{unit}\n", points.join(";")))
}

fn object(tick: &Tick, start: f64) -> String {
    let of = |(name, unit, of): &Quantity| Some((format!("{name}_{unit}").replace('µ', "u"), json!(of(tick)?)));
    let quantities: serde_json::Map<_, _> = QUANTITIES.iter().filter_map(of).collect();
    json!({ "timestamp": start + tick.seconds, "piezo": quantities }).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use protocol::Sample;
    use serde_json::Value;
    use std::num::NonZeroU8;
    use std::time::Duration;

    const CALIBRATION: estimator_core::AdcCalibration =
        estimator_core::AdcCalibration { gain_v_per_code: 0.01, offset_v: 0.0, invert: false, full_scale: 4095 };

    fn feed() -> Feed {
        Feed::new(CALIBRATION, None, 500)
    }

    fn frame(number: u16) -> Samples {
        let sample = Sample {
            code: if number == 33 { 4000 } else { 100 + number },
            sensor: None,
            displacement: f32::from(number),
            half_width: Some(0.5),
            dac: 0,
            status: Default::default(),
            faults: Default::default(),
        };
        Samples { first: number.into(), every: NonZeroU8::MIN, samples: [sample].into_iter().collect() }
    }

    /// What arrives, in columns of 20, of what `sends`.
    fn received(format: Format, sends: impl FnOnce(&mut Datagrams)) -> Vec<String> {
        let receiver = UdpSocket::bind("127.0.0.1:0").unwrap();
        receiver.set_read_timeout(Some(Duration::from_millis(200))).unwrap();
        let address = receiver.local_addr().unwrap().to_string();
        let mut datagrams = Datagrams::to(&address, format, 20, feed()).unwrap();
        sends(&mut datagrams);
        let mut buffer = [0; 2000];
        std::iter::from_fn(|| {
            let (length, _) = receiver.recv_from(&mut buffer).ok()?;
            Some(String::from_utf8(buffer[..length].to_vec()).unwrap())
        })
        .collect()
    }

    /// 41 samples of 500 µs, one of which leaps.
    fn leaps(datagrams: &mut Datagrams) {
        (0..41).for_each(|number| datagrams.take(&frame(number)));
    }

    #[test]
    fn teleplot_is_sent_a_line_a_quantity_with_the_glitch_in_it() {
        let received = received(Format::Teleplot, leaps);
        assert_eq!(received.len(), 2, "{received:?}");
        let lines: Vec<(&str, &str, &str)> = received[1]
            .lines()
            .map(|line| {
                let (line, unit) = line.split_once('§').unwrap();
                let (name, points) = line.split_once(':').unwrap();
                (name, points, unit)
            })
            .collect();
        let names: Vec<_> = lines.iter().map(|(name, _, unit)| (*name, *unit)).collect();
        assert_eq!(names, [("voltage", "V"), ("displacement", "µm"), ("half_width", "µm")]);
        let points: Vec<(f64, f64)> = lines[0]
            .1
            .split(';')
            .map(|point| point.split_once(':').unwrap())
            .map(|(ms, value)| (ms.parse().unwrap(), value.parse().unwrap()))
            .collect();
        assert!(points.iter().any(|(_, value)| *value == 40.0), "{points:?}");
        // Tick 20 and tick 33.
        assert!((points[1].0 - points[0].0 - 6.5).abs() < 0.002 && points[0].0 > 1e12, "{points:?}");
    }

    #[test]
    fn plotjuggler_is_sent_an_object_a_tick_with_its_time() {
        let received: Vec<Value> =
            received(Format::PlotJuggler, leaps).iter().map(|text| serde_json::from_str(text).unwrap()).collect();
        let times: Vec<f64> = received.iter().map(|object| object["timestamp"].as_f64().unwrap()).collect();
        assert!(times.is_sorted() && times[0] > 1e9, "{times:?}");
        let glitch = received.iter().find(|object| object["piezo"]["voltage_V"] == 40.0).expect("the glitch");
        assert_eq!(
            (&glitch["piezo"]["displacement_um"], &glitch["piezo"]["half_width_um"]),
            (&json!(32.0), &json!(0.5))
        );
        assert!(received.len() < 12 && glitch["piezo"].get("sensor_um").is_none(), "{received:?}");
    }

    #[test]
    fn another_link_s_ticks_come_after_those_of_the_one_before() {
        let sent = received(Format::PlotJuggler, |datagrams| {
            // Half a column of it is left.
            (0..30).for_each(|number| datagrams.take(&frame(number)));
            // The 15 ms that they take of a device.
            std::thread::sleep(Duration::from_millis(15));
            datagrams.restart(feed());
            (30..71).for_each(|number| datagrams.take(&frame(number)));
        });
        let sent: Vec<Value> = sent.iter().map(|text| serde_json::from_str(text).unwrap()).collect();
        let of =
            |field: fn(&Value) -> &Value| sent.iter().map(|tick| field(tick).as_f64().unwrap()).collect::<Vec<_>>();
        let (times, voltages) = (of(|tick| &tick["timestamp"]), of(|tick| &tick["piezo"]["voltage_V"]));
        assert!(times.is_sorted(), "{times:?}");
        // The first link's column of 20 ends at code 119, the next begins with code 131.
        assert!(voltages.iter().any(|&volt| volt < 1.2) && voltages.iter().any(|&volt| volt > 1.3), "{voltages:?}");
        assert!(!voltages.iter().any(|&volt| volt > 1.195 && volt < 1.305), "half a column was sent: {voltages:?}");
    }

    #[test]
    fn who_is_not_there_is_named() {
        let feed = Feed::new(emulator::TABLE.adc, None, 500);
        let refused = Datagrams::to("nowhere", Format::Teleplot, 10, feed).err().unwrap();
        assert!(refused.to_string().contains("nowhere: no address"), "{refused}");
    }
}
