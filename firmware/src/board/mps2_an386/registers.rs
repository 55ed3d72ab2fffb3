//! The CMSDK peripherals of AN386 (Arm DAI 0386): two timers and their interrupts.

use cortex_m::interrupt::InterruptNumber;
use cortex_m::peripheral::NVIC;

/// Clock of the core and its peripherals, Hz.
pub const CORE_HZ: u32 = 25_000_000;

const TIMER0: usize = 0x4000_0000;
const TIMER1: usize = 0x4000_1000;
/// Offsets within a timer.
const CTRL: usize = 0x0;
const VALUE: usize = 0x4;
const RELOAD: usize = 0x8;
const INTCLEAR: usize = 0xC;
const ENABLE: u32 = 1;
const INTERRUPT: u32 = 1 << 3;

/// Reads a register of this board's peripherals.
pub fn read(address: usize) -> u32 {
    // SAFETY: every caller names a peripheral's register, which takes any access of a word.
    unsafe { (address as *const u32).read_volatile() }
}

/// Writes a register of this board's peripherals.
pub fn write(address: usize, value: u32) {
    // SAFETY: as for `read`; no peripheral here reaches into memory.
    unsafe { (address as *mut u32).write_volatile(value) }
}

/// Timer 1 counts cycles, down from the top, for ever.
pub fn start_cycle_counter() {
    write(TIMER1 + RELOAD, u32::MAX);
    write(TIMER1 + VALUE, u32::MAX);
    write(TIMER1 + CTRL, ENABLE);
}

/// Cycles since some instant, modulo 2³².
pub fn cycles() -> u32 {
    !read(TIMER1 + VALUE)
}

/// Timer 0 interrupts every `period` cycles from now on.
pub fn start_timer(period: u32) {
    write(TIMER0 + RELOAD, period - 1);
    write(TIMER0 + VALUE, period - 1);
    write(TIMER0 + CTRL, ENABLE | INTERRUPT);
}

/// Ends timer 0's request.
pub fn acknowledge_timer() {
    write(TIMER0 + INTCLEAR, 1);
}

/// The interrupts in use.
#[derive(Clone, Copy)]
pub enum Interrupt {
    /// UART 0 has received.
    Uart0Receive = 0,
    /// Timer 0 has reached 0.
    Timer0 = 8,
}

// SAFETY: the numbers are those of AN386's interrupt table.
unsafe impl InterruptNumber for Interrupt {
    fn number(self) -> u16 {
        self as u16
    }
}

impl Interrupt {
    /// Enables it with a priority, 0 the highest.
    pub fn enable(self, nvic: &mut NVIC, priority: u8) {
        // SAFETY: at start, before any critical section that masks by priority.
        unsafe {
            nvic.set_priority(self, priority);
            NVIC::unmask(self);
        }
    }
}

unsafe extern "C" {
    fn Uart0Receive();
    fn Timer0();
    fn DefaultHandler();
}

/// The vectors after the core's own, as cortex-m-rt expects a device crate to have them.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
static __INTERRUPTS: [unsafe extern "C" fn(); 32] = {
    let mut table = [DefaultHandler as unsafe extern "C" fn(); 32];
    table[Interrupt::Uart0Receive as usize] = Uart0Receive;
    table[Interrupt::Timer0 as usize] = Timer0;
    table
};
