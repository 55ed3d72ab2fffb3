//! The DMA by its registers alone.

use super::*;

const MEMORY: u32 = RAM as u32 + 0x100;

/// DMA1 with its second channel set up for four bytes, off.
fn dma(peripheral: (u32, u32), control: u32) -> Dma {
    let mut dma = Dma::default();
    assert!(dma.write_mux(4, peripheral.1));
    for (register, value) in [(CPAR1, peripheral.0), (CMAR1, MEMORY), (CNDTR1, 4), (CCR1, MINC | control)] {
        assert!(dma.write(STRIDE + register, value).unwrap());
    }
    dma
}

fn on(dma: &mut Dma) -> Result<bool> {
    let control = dma.read(CCR2).unwrap();
    dma.write(CCR2, control | EN)
}

#[test]
fn a_ring_goes_round_and_says_where_it_is() {
    let mut dma = dma(RECEIVE, CIRC | HTIE | TCIE);
    assert!(!dma.receives());
    on(&mut dma).unwrap();
    let mut left = Vec::new();
    for byte in 0..6 {
        assert!(dma.receives());
        dma.receive(byte);
        left.push((dma.read(STRIDE + CNDTR1).unwrap(), dma.interrupt(2), dma.read(ISR).unwrap() >> 4));
        dma.write(IFCR, (CHTIF1 | CTCIF1) << 4).unwrap();
        assert!(!dma.interrupt(2));
    }
    let (half, complete) = (HTIF1 | GIF1, TCIF1 | GIF1);
    let expected = [(3, false, 0), (2, true, half), (1, false, 0), (4, true, complete), (3, false, 0), (2, true, half)];
    assert_eq!(left, expected);
    let at = |offset| MEMORY + offset;
    assert_eq!(dma.stored(), [(at(0), 0), (at(1), 1), (at(2), 2), (at(3), 3), (at(0), 4), (at(1), 5)]);
    assert!(!dma.stores());
}

#[test]
fn a_block_is_sent_once() {
    let mut dma = dma(TRANSMIT, DIR | TCIE);
    on(&mut dma).unwrap();
    assert_eq!(dma.wanted(), Some(MEMORY..MEMORY + 4));
    dma.load(vec![1, 2, 3, 4]);
    assert!(!dma.receives());
    let sent: Vec<u8> = std::iter::from_fn(|| dma.transmit()).collect();
    assert_eq!((sent, dma.interrupt(2), dma.wanted()), (vec![1, 2, 3, 4], true, None));
}

#[test]
fn what_is_not_promised_is_refused() {
    let mut halted = dma(RECEIVE, CIRC);
    on(&mut halted).unwrap();
    assert!(halted.write(STRIDE + CNDTR1, 4).is_err(), "the channel is on");
    halted.receive(1);
    halted.write(CCR2, MINC | CIRC).unwrap();
    let resumed = on(&mut halted).unwrap_err().to_string();
    assert!(resumed.contains("3 of 4 transfers left"), "{resumed}");
    for (peripheral, control) in
        [(RECEIVE, 1 << 8), (RECEIVE, 1 << 14), ((RECEIVE.0, 35), 0), (RECEIVE, DIR), (TRANSMIT, DIR | CIRC)]
    {
        assert!(on(&mut dma(peripheral, control)).is_err(), "{peripheral:x?} {control:#x}");
    }
}
