//! The words by which columns are called in the languages of instruments.

use measurement_files::Quantity;

/// Names that say what a column holds, alone or with [`NEUTRAL`] words.
const TIME: &[&str] = &[
    "t",
    "time",
    "timestamp",
    "time stamp",
    "elapsed time",
    "zeit",
    "zeitstempel",
    "uhrzeit",
    "messzeit",
    "temps",
    "tiempo",
    "tempo",
    "时间",
    "時間",
    "時刻",
    "시간",
];
const VOLTAGE: &[&str] = &[
    "v",
    "u",
    "voltage",
    "spannung",
    "piezospannung",
    "steuerspannung",
    "ausgangsspannung",
    "eingangsspannung",
    "antriebsspannung",
    "aktorspannung",
    "tension",
    "voltaje",
    "tensión",
    "tensione",
    "电压",
    "驱动电压",
    "输入电压",
    "输出电压",
    "压电电压",
    "電圧",
    "印加電圧",
    "駆動電圧",
    "전압",
];
const DISPLACEMENT: &[&str] = &[
    "y",
    "x",
    "displacement",
    "disp",
    "position",
    "pos",
    "auslenkung",
    "weg",
    "stellweg",
    "verschiebung",
    "verfahrweg",
    "istposition",
    "déplacement",
    "deplacement",
    "allongement",
    "élongation",
    "desplazamiento",
    "posición",
    "posicion",
    "spostamento",
    "posizione",
    "位移",
    "位置",
    "变形",
    "変位",
    "変位量",
    "伸び",
    "변위",
    "elongation",
    "stroke",
    "deflection",
    "travel",
];

/// Words that may stand beside a name and change nothing.
const NEUTRAL: &[&str] = &[
    "piezo",
    "control",
    "drive",
    "driving",
    "input",
    "output",
    "amplifier",
    "actuator",
    "measured",
    "current",
    "actual",
    "of",
    "out",
    "chan",
    "channel",
    "ch",
    "axis",
    "stage",
    "the",
    "gemessene",
    "gemessener",
    "gemessenes",
    "ist",
    "achse",
    "kanal",
    "du",
    "de",
    "del",
    "mesuré",
    "mesurée",
    "medido",
    "medida",
    "in",
    "estimated",
];

/// Words of displacement sensors.
const SENSOR: &[&str] = &[
    "sensor",
    "wegsensor",
    "wegaufnehmer",
    "aufnehmer",
    "gauge",
    "sgs",
    "lvdt",
    "capacitive",
    "kapazitiv",
    "interferometer",
    "vibrometer",
    "capteur",
    "sensore",
    "传感器",
    "位移传感器",
    "センサ",
    "センサー",
    "変位計",
    "변위센서",
];

/// Words of what has the unit of a voltage or a displacement and is none of the actuator's, at the beginning of a word.
const OTHER: &[&str] = &[
    "error",
    "erreur",
    "errore",
    "fehler",
    "abweichung",
    "regelabweichung",
    "deviation",
    "residual",
    "target",
    "ziel",
    "setpoint",
    "soll",
    "sollwert",
    "command",
    "cmd",
    "demand",
    "desired",
    "nominal",
    "consigne",
    "consigna",
    "objetivo",
    "riferimento",
    "référence",
    "reference",
    "referenz",
    "referencia",
    "supply",
    "versorgung",
    "alimentation",
    "battery",
    "batterie",
    "wavelength",
    "wellenlänge",
    "longueur",
    "误差",
    "偏差",
    "目标",
    "设定",
    "指令",
    "波长",
    "誤差",
    "目標",
    "波長",
];

/// Whether a name says that its column is none of the actuator's: `position error`, `Sollposition`, `set point`.
pub(super) fn is_other(name: &str) -> bool {
    let begins = |word: &str| OTHER.iter().any(|other| word.starts_with(other));
    let alone = |word: &str| matches!(word, "set" | "ref" | "sp" | "vcc" | "vdd" | "err");
    let within = OTHER.iter().any(|other| !other.is_ascii() && name.contains(other));
    within || name.split(' ').any(|word| begins(word) || alone(word))
}

/// What a name, in small letters with single spaces between its words, says that its column holds.
pub(super) fn quantity(name: &str) -> Option<Quantity> {
    let all = [(Quantity::Time, TIME), (Quantity::Voltage, VOLTAGE), (Quantity::Displacement, DISPLACEMENT)];
    if let Some((quantity, _)) = all.iter().find(|(_, names)| names.contains(&name)) {
        return Some(*quantity);
    }
    let telling: Vec<&str> = name.split(' ').filter(|word| !is_neutral(word)).collect();
    let of = |quantity, names: &[&str], beside: &[&str]| {
        let others: Vec<&&str> = telling.iter().filter(|word| !beside.contains(word)).collect();
        // A single letter among other words says nothing.
        matches!(others[..], [word] if word.chars().count() > 1 && names.contains(word)).then_some(quantity)
    };
    of(Quantity::Voltage, VOLTAGE, &[]).or_else(|| of(Quantity::Displacement, DISPLACEMENT, SENSOR))
}

fn is_neutral(word: &&str) -> bool {
    let unnumbered = word.trim_end_matches(|c: char| c.is_ascii_digit());
    unnumbered.is_empty() || NEUTRAL.contains(&unnumbered)
}

/// Whether a name is a displacement sensor's.
pub(super) fn is_sensor(name: &str) -> bool {
    let ideograms =
        |word: &str| !word.is_ascii() && SENSOR.iter().any(|sensor| !sensor.is_ascii() && word.contains(sensor));
    name.split(' ').any(|word| SENSOR.contains(&word) || ideograms(word))
}
