//! DMA1 with the DMAMUX before it (RM0440), as far as LPUART1 and DAC1 need them: bytes from the receiver to
//! memory, once or round and round, from memory to the transmitter, once, and half-words from memory to the DAC,
//! round and round.
//!
//! A request is served at once: what the bus costs is not modelled. Memory behind the core's back is: received bytes
//! are in memory before the next instruction, and a block to be sent is read as a whole when its channel is switched
//! on, so that what the firmware changes in it later does not show. A ring is read anew with every write of a register
//! and every return of a handler, not with each half-word fetched: one that is fetched while a handler fills its half
//! is what it was before.
//!
//! Refused is what the manual does not promise: a channel that is switched on again amid its block, and registers
//! written while the channel is on.

use std::{collections::VecDeque, mem, ops::Range};

use anyhow::{Result, ensure};

use crate::{
    bases::{DAC1, LPUART1},
    dac::DHR12R1,
    layout::{field, layout},
    ram::{RAM, RAM_SIZE},
    uart::{RDR, TDR},
};

/// Channels of DMA1.
const CHANNELS: usize = 8;
layout! {
    "DMA1" {
        ISR @ 0x00 { GIF1 = 0, TCIF1 = 1, HTIF1 = 2, TEIF1 = 3, GIF2 = 4, GIF8 = 28, TCIF8 = 29, HTIF8 = 30, TEIF8 = 31 }
        IFCR @ 0x04 { CGIF1 = 0, CTCIF1 = 1, CHTIF1 = 2, CTEIF1 = 3, CGIF8 = 28, CTCIF8 = 29, CHTIF8 = 30, CTEIF8 = 31 }
        CCR1 @ 0x08 {
            EN = 0, TCIE = 1, HTIE = 2, DIR = 4, CIRC = 5, PINC = 6, MINC = 7, PSIZE = 8..=9, MSIZE = 10..=11, MEM2MEM = 14,
        }
        CNDTR1 @ 0x0C { NDT = 0..=15 }
        CPAR1 @ 0x10 {}
        CMAR1 @ 0x14 {}
        CCR2 @ 0x1C {}
        CCR8 @ 0x94 {}
        CMAR8 @ 0xA0 {}
    }
    "DMAMUX" {
        C0CR @ 0x00 { DMAREQ_ID = 0..=6, SE = 16 }
        C7CR @ 0x1C {}
    }
}

/// What the next channel's registers lie behind those of the one before.
const STRIDE: u32 = CCR2 - CCR1;
const _: () = assert!(CCR8 == CCR1 + 7 * STRIDE && CMAR8 == CMAR1 + 7 * STRIDE);
const _: () = assert!(C7CR == C0CR + 4 * (CHANNELS as u32 - 1));

/// A channel's flags in ISR, and what clears them in IFCR.
const FLAGS: u32 = GIF1 | TCIF1 | HTIF1 | TEIF1;
/// Bits from a channel's flags to the next one's.
const WIDTH: u32 = GIF2.trailing_zeros();
const _: () =
    assert!(CGIF1 | CTCIF1 | CHTIF1 | CTEIF1 == FLAGS && CGIF8 | CTCIF8 | CHTIF8 | CTEIF8 == FLAGS << (7 * WIDTH));
const _: () = assert!(GIF8 | TCIF8 | HTIF8 | TEIF8 == FLAGS << (7 * WIDTH));
/// The flags lie at the places of their enables in CCR.
const _: () = assert!(TCIF1 == TCIE && HTIF1 == HTIE);

const REFUSED: u32 = PINC | MEM2MEM;
/// Sizes of both ends: bytes, or half-words of memory, which a register is given as words.
const BYTES: (u32, u32) = (0, 0);
const HALF_WORDS: (u32, u32) = (2, 1);

/// LPUART1's data registers and requests.
const RECEIVE: (u32, u32) = (LPUART1 + RDR, 34);
const TRANSMIT: (u32, u32) = (LPUART1 + TDR, 35);
/// DAC1's holding register and the request of its channel 1.
const CONVERT: (u32, u32) = (DAC1 + DHR12R1, 6);
#[cfg(test)]
pub const REQUESTS: [(&str, &str, u32); 3] =
    [("LPUART1", "RX", RECEIVE.1), ("LPUART1", "TX", TRANSMIT.1), ("DAC1", "CH1", CONVERT.1)];

#[derive(Clone, Default)]
struct Channel {
    control: u32,
    left: u32,
    peripheral: u32,
    memory: u32,
    /// What DMAMUX_CxCR asks for.
    request: u32,
    /// Transfers of a block.
    block: u32,
    flags: u32,
    /// Of a block to be sent, what is left; read at its start.
    bytes: VecDeque<u8>,
}

impl Channel {
    fn on(&self) -> bool {
        self.control & EN != 0
    }

    /// Which request it serves; a synchronised one is none that is modelled.
    fn id(&self) -> u32 {
        self.request & (DMAREQ_ID | SE)
    }

    /// Bytes of a transfer in memory.
    fn size(&self) -> u32 {
        1 << field(self.control, MSIZE)
    }

    fn switch_on(&mut self) -> Result<()> {
        let &mut Self { control, left, peripheral, memory, request, block, .. } = self;
        ensure!(control & REFUSED == 0 && control & MINC != 0, "CCR = {control:#x}: not modelled");
        ensure!(
            left == block && left > 0,
            "a channel with {left} of {block} transfers left is switched on: not promised to go on"
        );
        let (to, ring) = (control & DIR != 0, control & CIRC != 0);
        let (wants, sizes) = match self.id() {
            _ if !to => (RECEIVE, BYTES),
            id if id == CONVERT.1 => (CONVERT, HALF_WORDS),
            _ => (TRANSMIT, BYTES),
        };
        ensure!(
            (peripheral, self.id()) == wants && (field(control, PSIZE), field(control, MSIZE)) == sizes,
            "request {request:#x} for {peripheral:#x}, CCR = {control:#x}: only LPUART1's and DAC1's are modelled"
        );
        ensure!(
            !to || ring == (wants == CONVERT),
            "a block that is sent round and round, or is converted once, is not modelled"
        );
        let (from, to) = (u64::from(memory), u64::from(memory) + u64::from(left * self.size()));
        ensure!((RAM..=RAM + RAM_SIZE).contains(&from) && to <= RAM + RAM_SIZE, "DMA at {memory:#x}: not modelled");
        Ok(())
    }

    /// A transfer is done: the memory's address that it was of.
    fn step(&mut self) -> u32 {
        let address = self.memory + (self.block - self.left) * self.size();
        self.left -= 1;
        if self.left == self.block / 2 {
            self.flags |= HTIF1 | GIF1;
        }
        if self.left == 0 {
            self.flags |= TCIF1 | GIF1;
            if self.control & CIRC != 0 {
                self.left = self.block;
            }
        }
        address
    }
}

#[derive(Default)]
pub struct Dma {
    channels: [Channel; CHANNELS],
    /// Where a block is to be read that will be sent, and by which channel.
    wanted: Option<(usize, Range<u32>)>,
    /// Bytes on their way to memory.
    stored: Vec<(u32, u8)>,
}

impl Dma {
    fn ready(&mut self, (_, request): (u32, u32)) -> Option<&mut Channel> {
        let goes = |channel: &&mut Channel| channel.on() && channel.id() == request && channel.left > 0;
        self.channels.iter_mut().find(goes)
    }

    /// Whether a channel waits for what the receiver has.
    pub fn receives(&mut self) -> bool {
        self.ready(RECEIVE).is_some()
    }

    /// A byte that the receiver has, on its way to memory.
    pub fn receive(&mut self, byte: u8) {
        if let Some(channel) = self.ready(RECEIVE) {
            let address = channel.step();
            self.stored.push((address, byte));
        }
    }

    /// The next byte for the transmitter.
    pub fn transmit(&mut self) -> Option<u8> {
        let channel = self.ready(TRANSMIT)?;
        let byte = channel.bytes.pop_front()?;
        channel.step();
        Some(byte)
    }

    /// The next code for the DAC.
    pub fn convert(&mut self) -> Option<u16> {
        let channel = self.ready(CONVERT)?;
        let at = (channel.step() - channel.memory) as usize;
        let half = channel.bytes.range(at..at + 2).copied().collect::<Vec<u8>>();
        Some(u16::from_le_bytes([half[0], half[1]]))
    }

    /// The ring that is converted.
    pub fn ring(&self) -> Option<Range<u32>> {
        let ring = self.channels.iter().find(|channel| channel.on() && channel.id() == CONVERT.1)?;
        Some(ring.memory..ring.memory + ring.block * ring.size())
    }

    /// What is in it.
    pub fn see(&mut self, bytes: Vec<u8>) {
        if let Some(channel) = self.ready(CONVERT) {
            channel.bytes = bytes.into();
        }
    }

    /// Bytes that are to be in memory before the core looks again.
    pub fn stored(&mut self) -> Vec<(u32, u8)> {
        mem::take(&mut self.stored)
    }

    /// Whether there are any.
    pub fn stores(&self) -> bool {
        !self.stored.is_empty()
    }

    /// The block that a channel is to send; [`Dma::load`] hands it over.
    pub fn wanted(&self) -> Option<Range<u32>> {
        self.wanted.as_ref().map(|(_, block)| block.clone())
    }

    pub fn load(&mut self, bytes: Vec<u8>) {
        if let Some((channel, _)) = self.wanted.take() {
            self.channels[channel].bytes = bytes.into();
        }
    }

    /// The interrupt line of a channel, counted from 1.
    pub fn interrupt(&self, channel: usize) -> bool {
        let Channel { flags, control, .. } = self.channels[channel - 1];
        flags & control & (TCIE | HTIE) != 0
    }

    pub fn read(&self, offset: u32) -> Option<u32> {
        if offset == ISR {
            let flags = self.channels.iter().enumerate();
            return Some(
                flags.fold(0, |all, (channel, Channel { flags, .. })| all | flags << (WIDTH * channel as u32)),
            );
        }
        let (channel, register) = place(offset)?;
        let channel = &self.channels[channel];
        Some(match register {
            CCR1 => channel.control,
            CNDTR1 => channel.left,
            CPAR1 => channel.peripheral,
            CMAR1 => channel.memory,
            _ => return None,
        })
    }

    pub fn write(&mut self, offset: u32, value: u32) -> Result<bool> {
        if offset == IFCR {
            for (at, channel) in self.channels.iter_mut().enumerate() {
                let cleared = field(value, FLAGS << (WIDTH * at as u32));
                channel.flags &= if cleared & CGIF1 == 0 { !cleared } else { 0 };
                if channel.flags == GIF1 {
                    channel.flags = 0;
                }
            }
            return Ok(true);
        }
        let Some((at, register)) = place(offset) else { return Ok(false) };
        let channel = &mut self.channels[at];
        if register == CCR1 {
            let was_on = channel.on();
            ensure!(!was_on || value & EN == 0 || value == channel.control, "CCR = {value:#x} while the channel is on");
            channel.control = value;
            if !was_on && channel.on() {
                channel.switch_on()?;
                if value & DIR != 0 {
                    self.wanted = Some((at, channel.memory..channel.memory + channel.left * channel.size()));
                }
            }
            return Ok(true);
        }
        ensure!(!channel.on(), "{value:#x} is written to {offset:#x} while the channel is on");
        match register {
            CNDTR1 => (channel.left, channel.block) = (value & NDT, value & NDT),
            CPAR1 => channel.peripheral = value,
            CMAR1 => channel.memory = value,
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// Reads a register of the DMAMUX.
    pub fn read_mux(&self, offset: u32) -> Option<u32> {
        self.channels.get(offset as usize / 4).map(|channel| channel.request)
    }

    pub fn write_mux(&mut self, offset: u32, value: u32) -> bool {
        let Some(channel) = self.channels.get_mut(offset as usize / 4) else { return false };
        channel.request = value;
        true
    }
}

/// The channel and the register of it at an offset.
fn place(offset: u32) -> Option<(usize, u32)> {
    let behind = offset.checked_sub(CCR1)?;
    let channel = (behind / STRIDE) as usize;
    (channel < CHANNELS).then_some((channel, CCR1 + behind % STRIDE))
}

#[cfg(test)]
mod tests;
