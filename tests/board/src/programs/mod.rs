//! Programs of a few instructions, run on the whole board: what the core does with faults, interrupts,
//! sleep and resets.

mod faults;
mod flash;
mod interrupts;

use crate::{Board, Contents, Image};

const STACK: u32 = 0x2000_8000;
const FLASH: u32 = 0x0800_0000;
/// Where the handler of [`board`]'s exception, the program, and the table that START works off are.
const HANDLER: u32 = 0x300;
const MAIN: u32 = 0x400;
const TABLE: u32 = 0x1000;
/// Where handlers leave what they saw.
const SEEN: u32 = 0x2000_0100;

/// `ldr r0, =table; 1: ldmia r0!, {r1, r2}; cbz r1, 2f; str r2, [r1]; b 1b; 2: bx r2`
const START: [u16; 8] = [0x4802, 0xC806, 0xB109, 0x600A, 0xE7FB, 0x4710, 0x1000, 0x0800];
/// Stores the stacked PC and LR at SEEN, asks for a reset, waits for it.
const FAULT_HANDLER: [u16; 16] = [
    0x4804, 0x9906, 0x6001, 0xF8C0, 0xE004, 0x4803, 0x4903, 0x6001, 0xE7FE, 0, 0x0100, 0x2000, 0xED0C, 0xE000, 0x0004,
    0x05FA,
];
/// Clears TIM6_SR, adds one to the word at SEEN: eight instructions.
const COUNTING_HANDLER: [u16; 12] =
    [0x4803, 0x2100, 0x6001, 0x4803, 0x6801, 0x3101, 0x6001, 0x4770, 0x1010, 0x4000, 0x0100, 0x2000];
/// Clears ECCD, adds one to r7.
const NMI_HANDLER: [u16; 8] = [0x4802, 0x2101, 0x07C9, 0x6001, 0x3701, 0x4770, 0x2018, 0x4002];
const BX_LR: [u16; 1] = [0x4770];
/// The endless loop `b .`
const STAY: u16 = 0xE7FE;

const AIRCR_IGNORED: (u32, u32) = (0xE000_ED0C, 0);
const TIM6_CLOCK: (u32, u32) = (0x4002_1058, 1 << 28 | 1 << 4);
/// To 170 MHz: PWR's clock, range 1 boost, four wait states, HSE / 6 × 85 / 2, the core at half of it, and a
/// microsecond later at all of it.
const HALF_SPEED: [(u32, u32); 5] = [
    (0x4002_1058, 1 << 28),
    (0x4000_7080, 0),
    (0x4002_2000, 4),
    (0x4002_100C, 3 | 5 << 4 | 85 << 8 | 1 << 24),
    (0x4002_1008, 3 | 8 << 4),
];
const FULL_SPEED: (u32, u32) = (0x4002_1008, 3);
/// Clocks before a program starts.
const SPEED_UP: u64 = 170;
const KEYS: [(u32, u32); 2] = [(0x4002_2008, 0x4567_0123), (0x4002_2008, 0xCDEF_89AB)];
const FLASH_CR: u32 = 0x4002_2014;
const ISER0: u32 = 0xE000_E100;
const ISPR0: u32 = 0xE000_E200;
const PAGE_127: u32 = Contents::START + 127 * 2048;

/// A board at 170 MHz that stores the table's values at its addresses and then runs `main`;
/// `handler` serves `exception`.
fn board(table: &[(u32, u32)], main: &[u16], exception: u8, handler: &[u16]) -> Board {
    let halves = |words: &[u32]| words.iter().flat_map(|word| [*word as u16, (word >> 16) as u16]).collect::<Vec<_>>();
    let table: Vec<u32> = table.iter().chain(&[(0, (FLASH + MAIN) | 1)]).flat_map(|&(a, v)| [a, v]).collect();
    let image = Image::assembled(&[
        (0, &halves(&[STACK, (FLASH + 0x200) | 1])),
        (4 * usize::from(exception), &halves(&[(FLASH + HANDLER) | 1])),
        (0x200, &START),
        (HANDLER as usize, handler),
        (MAIN as usize, main),
        (TABLE as usize, &halves(&table)),
    ]);
    let mut board = Board::power_on(&image).unwrap();
    let machine = board.machine_mut();
    HALF_SPEED.iter().for_each(|&(address, value)| machine.write(address, 4, value));
    machine.clock += SPEED_UP;
    machine.skipped += SPEED_UP;
    machine.write(FULL_SPEED.0, 4, FULL_SPEED.1);
    board
}

fn word(board: &Board, address: u32) -> u32 {
    board.cpu.word(address).unwrap()
}

/// TIM6's interrupt every `period` clocks.
fn ticking(period: u32) -> Vec<(u32, u32)> {
    let table = [TIM6_CLOCK, (0x4000_102C, period - 1), (0x4000_100C, 1), (ISER0 + 4, 1 << 22), (0x4000_1000, 1)];
    table.to_vec()
}
