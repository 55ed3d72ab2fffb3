//! The versions of what lies in flash and goes over the wire are those that the documents state.

use estimator_core::record;
use std::fs;
use std::path::Path;

#[test]
fn the_documents_state_the_versions_of_the_formats() {
    let stated = [
        ("RELEASING.md", format!("| version {} | `estimator-core/src/record.rs`", record::VERSION)),
        ("RELEASING.md", format!("| protocol version {} | `protocol/src/frame.rs`", protocol::VERSION)),
        ("book/src/formats.md", format!("version {}, at most {} bytes", record::VERSION, record::MAX_LENGTH)),
        ("book/src/formats.md", format!("## The wire: protocol version {}", protocol::VERSION)),
        ("CHANGELOG.md", format!("record version {}, protocol version {}", record::VERSION, protocol::VERSION)),
    ];
    for (document, words) in stated {
        let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(document)).unwrap();
        assert!(text.contains(&words), "{document} should say {words:?}");
    }
}
