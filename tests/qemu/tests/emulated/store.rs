//! Push, reset, info: the table that a device starts with.

use qemu_test::Board;

#[test]
fn a_pushed_table_is_used_after_the_reset_and_bad_ones_change_nothing() {
    let board = Board::power_on();
    let compiled = board.info();
    assert!(compiled["identity"]["source"]["Compiled"].is_object(), "{compiled:#}");
    let table = board.table("wider", &["--dac-span", "-10:60"]);
    let table = table.to_str().unwrap();

    let complaint = board.refuses("push", &[table, "--doubted"]);
    assert!(complaint.contains("estimating") && complaint.contains("--pause"), "{complaint}");
    assert_eq!(board.info()["identity"], compiled["identity"]);

    board.does("push", &[table, "--pause", "--reset", "--doubted"]);
    let stored = board.info();
    assert_eq!(stored["identity"]["source"], "Stored", "{stored:#}");
    assert_ne!(stored["identity"]["table_crc"], compiled["identity"]["table_crc"]);
    board.does("pull", &["--out", "pulled.bin"]);
    let pushed = std::fs::read(board.folder.path().join("wider/table.bin")).unwrap();
    assert_eq!(std::fs::read(board.folder.path().join("pulled.bin")).unwrap(), pushed);

    let mut corrupt = pushed.clone();
    corrupt[50] ^= 4;
    let path = board.folder.path().join("corrupt.bin");
    std::fs::write(&path, corrupt).unwrap();
    let complaint = board.refuses("push", &[path.to_str().unwrap(), "--pause", "--reset", "--doubted"]);
    assert!(complaint.contains("corrupt"), "{complaint}");
    let foreign = board.table_for("4095", "foreign", &[]);
    let complaint = board.refuses("push", &[foreign.to_str().unwrap(), "--pause", "--reset", "--doubted"]);
    assert!(complaint.contains("65520"), "{complaint}");
    assert_eq!(board.info()["identity"], stored["identity"]);
    board.does("reset", &[]);
    assert_eq!(board.info()["identity"], stored["identity"], "it survives a reset");

    board.does("erase", &["--pause", "--reset"]);
    assert_eq!(board.info()["identity"], compiled["identity"]);
}

/// Enough of them that pages are left and erased.
#[test]
fn the_last_of_many_pushed_tables_is_the_one() {
    let board = Board::power_on();
    let tables = [board.table("one", &["--dac-span", "-10:60"]), board.table("two", &["--dac-span", "-20:60"])];
    for k in 0..30 {
        board.does("push", &[tables[k % 2].to_str().unwrap(), "--while-estimating", "--doubted"]);
    }
    board.does("reset", &[]);
    board.does("pull", &["--out", "pulled.bin"]);
    let last = std::fs::read(tables[1].with_file_name("table.bin")).unwrap();
    assert_eq!(std::fs::read(board.folder.path().join("pulled.bin")).unwrap(), last);
}
