//! Where each peripheral's registers begin (RM0440, "Memory map and peripheral register boundary addresses").

/// Declares constants, and for tests the list of them with their names.
macro_rules! bases {
    ($($(#[$documentation:meta])* $name:ident = $address:literal,)*) => {
        $($(#[$documentation])* pub const $name: u32 = $address;)*

        #[cfg(test)]
        pub const ALL: &[(&str, u32)] = &[$((stringify!($name), $name)),*];
    };
}

bases! {
    TIM5 = 0x4000_0C00,
    TIM6 = 0x4000_1000,
    TIM7 = 0x4000_1400,
    IWDG = 0x4000_3000,
    PWR = 0x4000_7000,
    LPUART1 = 0x4000_8000,
    DMA1 = 0x4002_0000,
    DMAMUX = 0x4002_0800,
    RCC = 0x4002_1000,
    FLASH = 0x4002_2000,
    GPIOA = 0x4800_0000,
    GPIOB = 0x4800_0400,
    GPIOC = 0x4800_0800,
    ADC1 = 0x5000_0000,
    /// What ADC1 and ADC2 have in common.
    ADC12_COMMON = 0x5000_0300,
    DAC1 = 0x5000_0800,
}

/// The core's own registers (Armv7-M).
pub const SCS: u32 = 0xE000_E000;
/// Data watchpoint and trace unit: the cycle counter.
pub const DWT: u32 = 0xE000_1000;
