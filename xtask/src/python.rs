//! The wheel: built as a release builds it, but for its optimisation; installed where nothing else is;
//! tested from Python.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use xshell::{Shell, cmd};

/// The folder of the package.
const PACKAGE: &str = "python";
/// The feature by which maturin's cargo finds the foreign crates that the tests are built with.
const FEATURE: &str = "beside-the-workspace";

/// Builds the wheel, installs it into an empty environment, and runs its tests and its notebook there. `piezo` is the
/// host tool, whose numbers the wheel's must be.
///
/// # Errors
/// Something of it fails.
pub fn check(sh: &Shell, piezo: &Path) -> Result<()> {
    let folder = piezo.ancestors().nth(2).context("the host tool lies in no target folder")?.join(PACKAGE);
    sh.remove_path(&folder)?;
    let (tools, empty, wheels) = (folder.join("tools"), folder.join("empty"), folder.join("wheels"));
    let pinned = sh.current_dir().join(PACKAGE).join("requirements.txt");

    cmd!(sh, "python3 -m venv {tools}").run()?;
    let pip = |environment: &Path| {
        let python = program(environment, "python");
        let pip = program(&tools, "python");
        cmd!(sh, "{pip} -m pip --disable-pip-version-check --python {python} install --quiet --no-compile")
    };
    pip(&tools).args(["maturin", "--constraint"]).arg(&pinned).run()?;
    let maturin = program(&tools, "maturin");
    cmd!(
        sh,
        "{maturin} build --quiet --locked --profile dev --manifest-path {PACKAGE}/Cargo.toml --features {FEATURE}"
    )
    .arg("--out")
    .arg(&wheels)
    .run()?;

    cmd!(sh, "python3 -m venv --without-pip {empty}").run()?;
    let wheel = sh.read_dir(&wheels)?.pop().context("maturin made no wheel")?;
    // By what the wheel says that it needs, and nothing else.
    pip(&empty).arg(&wheel).arg("--constraint").arg(&pinned).run()?;
    let python = program(&empty, "python");
    cmd!(sh, "{python} -c 'import piezo_estimator; print(piezo_estimator.__name__, piezo_estimator.__version__)'")
        .run()?;

    pip(&empty).arg("--requirement").arg(&pinned).run()?;
    let _in = sh.push_dir(PACKAGE);
    Ok(cmd!(sh, "{python} -m pytest -p no:cacheprovider")
        .env("PIEZO", piezo)
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .run()?)
}

/// A program of an environment.
fn program(environment: &Path, name: &str) -> PathBuf {
    environment.join(if cfg!(windows) { "Scripts" } else { "bin" }).join(name)
}
