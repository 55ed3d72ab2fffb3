//! The header says what the library has.

use cbindgen::{Builder, Config};
use std::path::Path;

#[test]
fn the_header_is_what_the_library_declares() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = Config::from_file(root.join("cbindgen.toml")).unwrap();
    let bindings = Builder::new().with_crate(root).with_config(config).generate().unwrap();
    let mut header = Vec::new();
    bindings.write(&mut header);
    // `UPDATE_EXPECT=1 cargo test -p estimator-c` writes it.
    expect_test::expect_file!["../include/piezo_estimator.h"].assert_eq(&String::from_utf8(header).unwrap());
}
