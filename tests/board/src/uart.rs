//! LPUART1 with its FIFOs (RM0440), and the wire to the host: 8N1, bytes in both directions at the line rate.
//!
//! The host sends at its own rate; firmware that is not within 2 % of it is refused. A byte that finds the receiver
//! full is lost and raises the overrun flag; one whose stop bit is missing raises the framing error's and is received
//! like others. Noise and parity errors never happen. FIFO thresholds are refused.

use std::collections::VecDeque;

use anyhow::{Result, ensure};

use crate::{
    CORE_HZ, NEVER,
    layout::{field, layout},
};

layout! {
    "LPUART1" {
        CR1 @ 0x00 {
            UE = 0, RE = 2, TE = 3, IDLEIE = 4, RXNEIE = 5, TCIE = 6, TXEIE = 7, PCE = 10, M0 = 12, M1 = 28, FIFOEN = 29,
        }
        CR3 @ 0x08 {
            EIE = 0, HDSEL = 3, DMAR = 6, DMAT = 7, RTSE = 8, CTSE = 9, DDRE = 13, TXFTIE = 23, RXFTIE = 28,
        }
        BRR @ 0x0C { DIVIDER as "BRR" = 0..=19 }
        ISR @ 0x1C { FE = 1, ORE = 3, IDLE = 4, RXNE = 5, TC = 6, TXE = 7, TEACK = 21, REACK = 22 }
        ICR @ 0x20 { FECF = 1, ORECF = 3, IDLECF = 4, TCCF = 6 }
        RDR @ 0x24 {}
        TDR @ 0x28 {}
        PRESC @ 0x2C { PRESCALER = 0..=3 }
    }
}

/// Flags, each at the place of its enable in CR1.
const ASKING: u32 = IDLE | RXNE | TC | TXE;
const _: () = assert!(IDLEIE | RXNEIE | TCIE | TXEIE == ASKING);
/// Flags, each at the place of what clears it in ICR.
const CLEARED: u32 = FE | ORE | IDLE | TC;
const _: () = assert!(FECF | ORECF | IDLECF | TCCF == CLEARED);
/// Of CR1: frames other than 8N1.
const OTHER_FRAMES: u32 = M1 | M0 | PCE;
/// Of CR3: half duplex, flow control, DMA that stops at an error, FIFO threshold interrupts.
const REFUSED: u32 = HDSEL | RTSE | CTSE | DDRE | TXFTIE | RXFTIE;
/// Start bit, eight data bits, stop bit.
const BITS: u64 = 10;
const DIVIDERS: [u64; 12] = [1, 2, 4, 6, 8, 10, 12, 16, 32, 64, 128, 256];

/// The host's line rate, and the core clocks that its bytes take.
const BAUD: u32 = 921_600;
const BYTE: u64 = BITS * CORE_HZ as u64 / BAUD as u64;

/// The host's end of the line.
#[derive(Default)]
pub struct Wire {
    /// Bytes, and whether their stop bits are sound.
    pub sent: VecDeque<(u8, bool)>,
    pub received: Vec<u8>,
}

pub struct Uart {
    cr1: u32,
    cr3: u32,
    divider: u32,
    prescaler: u32,
    /// FE, ORE, IDLE and TC; the other flags follow from the FIFOs.
    flags: u32,
    receiver: VecDeque<u8>,
    transmitter: VecDeque<u8>,
    /// The byte on the line and the clock at which it is through.
    sending: Option<(u8, u64)>,
    /// The clock at which the host's next byte is through or, behind the last, the line has been idle for a byte.
    receiving: u64,
}

impl Uart {
    pub fn new() -> Self {
        Self {
            cr1: 0,
            cr3: 0,
            divider: 0,
            prescaler: 0,
            flags: TC,
            receiver: VecDeque::new(),
            transmitter: VecDeque::new(),
            sending: None,
            receiving: NEVER,
        }
    }

    pub fn due(&self) -> u64 {
        self.receiving.min(self.sending.map_or(NEVER, |(_, end)| end))
    }

    /// The host has put bytes on the wire.
    pub fn listen(&mut self, now: u64, wire: &Wire) {
        if (self.receiving == NEVER || self.receiving <= now) && !wire.sent.is_empty() {
            self.receiving = now + BYTE;
        }
    }

    fn depth(&self) -> usize {
        if self.cr1 & FIFOEN == 0 { 1 } else { 8 }
    }

    /// Core clocks a byte takes, if that is what it takes the host.
    fn byte(&self) -> Result<u64> {
        let own = BITS * u64::from(self.divider) * DIVIDERS[field(self.prescaler, PRESCALER).min(11) as usize] / 256;
        ensure!(own.abs_diff(BYTE) * 50 <= BYTE, "a byte takes LPUART1 {own} clocks, the host ({BAUD} baud) {BYTE}");
        Ok(own)
    }

    fn send(&mut self, at: u64) -> Result<()> {
        self.sending = match self.transmitter.pop_front() {
            Some(byte) => Some((byte, at + self.byte()?)),
            None => None,
        };
        Ok(())
    }

    /// What is due at `at`. Adds the bytes lost to `overruns`.
    pub fn advance(&mut self, at: u64, wire: &mut Wire, overruns: &mut u32) -> Result<()> {
        if let Some((byte, _)) = self.sending.filter(|&(_, end)| end == at) {
            wire.received.push(byte);
            self.send(at)?;
            if self.sending.is_none() {
                self.flags |= TC;
            }
        }
        if self.receiving == at {
            match wire.sent.pop_front() {
                Some((byte, sound)) => {
                    self.receive(byte, sound, overruns)?;
                    self.receiving = at + BYTE;
                }
                None => {
                    self.flags |= IDLE;
                    self.receiving = NEVER;
                }
            }
        }
        Ok(())
    }

    fn receive(&mut self, byte: u8, sound: bool, overruns: &mut u32) -> Result<()> {
        if self.cr1 & (UE | RE) != UE | RE {
            return Ok(());
        }
        self.byte()?;
        if !sound {
            self.flags |= FE;
        }
        if self.receiver.len() < self.depth() {
            self.receiver.push_back(byte);
        } else {
            self.flags |= ORE;
            *overruns += 1;
        }
        Ok(())
    }

    fn status(&self) -> u32 {
        let when = |condition, flag| if condition { flag } else { 0 };
        self.flags
            | when(!self.receiver.is_empty(), RXNE)
            | when(self.transmitter.len() < self.depth(), TXE)
            | when(self.cr1 & (UE | TE) == UE | TE, TEACK)
            | when(self.cr1 & (UE | RE) == UE | RE, REACK)
    }

    pub fn interrupt(&self) -> bool {
        let status = self.status();
        // An overrun counts as RXNE or as an error.
        status & self.cr1 & ASKING != 0
            || status & ORE != 0 && self.cr1 & RXNEIE != 0
            || status & (FE | ORE) != 0 && self.cr3 & EIE != 0
    }

    /// Whether DMA is to take a received byte.
    pub fn wants_to_store(&self) -> bool {
        self.cr3 & DMAR != 0 && !self.receiver.is_empty()
    }

    /// The oldest received byte; 0 where there is none.
    pub fn take(&mut self) -> u8 {
        self.receiver.pop_front().unwrap_or(0)
    }

    /// Whether DMA is to bring a byte to be sent.
    pub fn wants_to_send(&self) -> bool {
        self.cr3 & DMAT != 0 && self.cr1 & (UE | TE) == UE | TE && self.transmitter.len() < self.depth()
    }

    /// A byte is to be sent.
    pub fn put(&mut self, byte: u8, now: u64) -> Result<()> {
        ensure!(self.cr1 & (UE | TE) == UE | TE, "TDR is written while the transmitter is off");
        ensure!(self.transmitter.len() < self.depth(), "TDR is written while the transmitter is full");
        self.flags &= !TC;
        self.transmitter.push_back(byte);
        if self.sending.is_none() {
            self.send(now)?;
        }
        Ok(())
    }

    pub fn read(&mut self, offset: u32) -> Option<u32> {
        Some(match offset {
            CR1 => self.cr1,
            CR3 => self.cr3,
            BRR => self.divider,
            PRESC => self.prescaler,
            ISR => self.status(),
            ICR | TDR => 0,
            RDR => self.take().into(),
            _ => return None,
        })
    }

    pub fn write(&mut self, offset: u32, value: u32, now: u64) -> Result<bool> {
        match offset {
            CR1 => {
                ensure!(value & OTHER_FRAMES == 0, "CR1 = {value:#x}: only 8N1 is modelled");
                self.cr1 = value;
            }
            CR3 => {
                ensure!(
                    value & REFUSED == 0,
                    "CR3 = {value:#x}: flow control, FIFO thresholds or DMA that stops at an error are not modelled"
                );
                self.cr3 = value;
            }
            BRR => self.divider = value & DIVIDER,
            PRESC => self.prescaler = value,
            ICR => self.flags &= !(value & CLEARED),
            TDR => self.put(value as u8, now)?,
            ISR | RDR => {}
            _ => return Ok(false),
        }
        Ok(true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(cr1: u32) -> (Uart, Wire) {
        let (mut uart, wire) = (Uart::new(), Wire::default());
        uart.write(BRR, 47_222, 0).unwrap();
        uart.write(CR1, UE | RE | TE | cr1, 0).unwrap();
        (uart, wire)
    }

    fn run(uart: &mut Uart, wire: &mut Wire) -> (u64, u32) {
        let (mut last, mut overruns) = (0, 0);
        while uart.due() != NEVER {
            last = uart.due();
            uart.advance(last, wire, &mut overruns).unwrap();
        }
        (last, overruns)
    }

    #[test]
    fn bytes_leave_at_the_line_rate() {
        let (mut uart, mut wire) = line(FIFOEN | TC);
        for byte in b"frame" {
            uart.write(TDR, u32::from(*byte), 0).unwrap();
        }
        assert!(!uart.interrupt());
        let (last, _) = run(&mut uart, &mut wire);
        assert_eq!((wire.received.as_slice(), last), (b"frame".as_slice(), 5 * 1844));
        assert!(uart.interrupt(), "transmission complete");
    }

    #[test]
    fn a_receiver_nobody_reads_keeps_the_first_bytes_and_says_that_it_lost_some() {
        for (cr1, depth) in [(0, 1), (FIFOEN, 8)] {
            let (mut uart, mut wire) = line(cr1 | RXNE);
            wire.sent.extend(b"0123456789".map(|byte| (byte, true)));
            uart.listen(0, &wire);
            let (last, overruns) = run(&mut uart, &mut wire);
            assert_eq!((last, overruns), (11 * 1844, 10 - depth), "ten bytes, and one of silence");
            let read: Vec<u8> = (0..depth).map(|_| uart.read(RDR).unwrap() as u8).collect();
            assert_eq!(read, &b"0123456789"[..depth as usize]);
            assert_eq!(uart.status() & (ORE | IDLE | RXNE), ORE | IDLE);
            assert!(uart.interrupt());
            uart.write(ICR, ORE, 0).unwrap();
            assert!(!uart.interrupt());
        }
    }

    #[test]
    fn another_baud_rate_than_the_hosts_is_refused() {
        let (mut uart, _) = line(0);
        uart.write(BRR, 47_222 * 8, 0).unwrap();
        assert!(uart.write(TDR, 0, 0).is_err());
    }
}
