//! A page open in the browser, and what it complained of while it loaded.

use std::{
    mem, thread,
    time::{Duration, Instant},
};

use anyhow::{Context, Result, bail, ensure};
use base64::prelude::{BASE64_STANDARD, Engine as _};
use serde_json::{Value, json};

use crate::{Browser, layout::Layout, viewport::Viewport};

/// A page in the browser; closed when dropped.
pub struct Page<'b> {
    browser: &'b mut Browser,
    url: String,
    target: String,
    session: String,
}

/// How often [`Page::until`] looks.
const LOOK: Duration = Duration::from_millis(50);
/// What [`Page::troubles`] has the page log to find the end of what it reported before.
const END: &str = "report-browser-test: end";

impl<'b> Page<'b> {
    /// Opens a page in a tab of its own and waits until it has settled.
    ///
    /// # Errors
    /// The browser cannot open it.
    pub fn open(browser: &'b mut Browser, url: &str, viewport: Viewport) -> Result<Self> {
        let target = browser.call(None, "Target.createTarget", &json!({ "url": "about:blank" }))?;
        let target = text(&target, "targetId")?;
        let session = browser.call(None, "Target.attachToTarget", &json!({ "targetId": target, "flatten": true }))?;
        let session = text(&session, "sessionId")?;
        let mut page = Self { browser, url: url.to_owned(), target, session };
        for domain in ["Page", "Runtime", "Log", "Network"] {
            page.call(&format!("{domain}.enable"), json!({}))?;
        }
        page.call("Page.setLifecycleEventsEnabled", json!({ "enabled": true }))?;
        page.call(
            "Emulation.setDeviceMetricsOverride",
            json!({
                "width": viewport.width,
                "height": viewport.height,
                "deviceScaleFactor": viewport.scale,
                "mobile": viewport.mobile,
            }),
        )?;
        let loading = page.call("Page.navigate", json!({ "url": url }))?;
        ensure!(loading["errorText"].is_null(), "{url}: {}", loading["errorText"]);
        page.browser.wait(&page.session, |event| {
            event["method"] == "Page.lifecycleEvent"
                && event["params"]["name"] == "networkAlmostIdle"
                && event["params"]["loaderId"] == loading["loaderId"]
        })?;
        Ok(page)
    }

    /// Has it no script run, and loads it anew.
    ///
    /// # Errors
    /// The browser's.
    pub fn without_scripts(&mut self) -> Result<()> {
        self.call("Emulation.setScriptExecutionDisabled", json!({ "value": true }))?;
        self.browser.take_events(&self.session);
        self.call("Page.reload", json!({}))?;
        self.browser.wait(&self.session, |event| event["method"] == "Page.loadEventFired")
    }

    fn call(&mut self, method: &str, parameters: Value) -> Result<Value> {
        self.browser.call(Some(&self.session), method, &parameters)
    }

    /// The value of an expression, or of what it promises.
    ///
    /// # Errors
    /// It throws, or the browser fails.
    pub fn evaluate(&mut self, expression: &str) -> Result<Value> {
        let parameters = json!({ "expression": expression, "awaitPromise": true, "returnByValue": true });
        let mut answer = self.call("Runtime.evaluate", parameters)?;
        if let Some(thrown) = answer.get("exceptionDetails") {
            bail!("{}", thrown["exception"]["description"]);
        }
        Ok(mem::take(&mut answer["result"]["value"]))
    }

    /// Waits until an expression is true.
    ///
    /// # Errors
    /// It does not come true in time, it throws, or the browser fails.
    pub fn until(&mut self, expression: &str, patience: Duration) -> Result<()> {
        let start = Instant::now();
        while self.evaluate(&format!("Boolean({expression})"))? != Value::Bool(true) {
            if start.elapsed() > patience {
                bail!("{expression} is not so; the page says: {}", self.evaluate("document.body.innerText")?);
            }
            thread::sleep(LOOK);
        }
        Ok(())
    }

    /// Everything that is wrong with the page, that shows so many plots, as it is now.
    ///
    /// # Errors
    /// The browser's, not the page's.
    pub fn faults(&mut self, viewport: Viewport, plots: usize) -> Result<Vec<String>> {
        let layout = self.layout()?;
        let mut faults = self.troubles()?;
        faults.extend(layout.faults(viewport, plots));
        Ok(faults)
    }

    /// Measures the page.
    ///
    /// # Errors
    /// The browser's.
    pub(crate) fn layout(&mut self) -> Result<Layout> {
        let found = self.evaluate(include_str!("layout.js")).context("layout.js failed")?;
        let json = found.as_str().context("layout.js returns no text")?;
        serde_json::from_str(json).context("layout.js and layout.rs disagree")
    }

    /// Exceptions, errors on the console, and requests for anything beyond the page itself, since it was opened or this
    /// was asked before.
    ///
    /// # Errors
    /// The browser's.
    pub fn troubles(&mut self) -> Result<Vec<String>> {
        self.evaluate(&format!("console.debug('{END}')"))?;
        self.browser.wait(&self.session, |event| {
            event["method"] == "Runtime.consoleAPICalled" && event["params"]["args"][0]["value"] == END
        })?;
        let events = self.browser.take_events(&self.session);
        Ok(events.iter().filter_map(|event| trouble(event, &self.url)).collect())
    }

    /// The whole page as a PNG image, beyond the screen's lower edge too.
    ///
    /// # Errors
    /// The browser's.
    pub fn screenshot(&mut self) -> Result<Vec<u8>> {
        let parameters = json!({ "format": "png", "captureBeyondViewport": true });
        bytes(&self.call("Page.captureScreenshot", parameters)?)
    }

    /// The page as printed.
    ///
    /// # Errors
    /// The browser's.
    pub fn pdf(&mut self) -> Result<Vec<u8>> {
        bytes(&self.call("Page.printToPDF", json!({}))?)
    }
}

impl Drop for Page<'_> {
    fn drop(&mut self) {
        // Fails only when the browser is gone already.
        let _ = self.browser.call(None, "Target.closeTarget", &json!({ "targetId": self.target }));
    }
}

/// What an event says is wrong with the page.
fn trouble(event: &Value, own_url: &str) -> Option<String> {
    let of = &event["params"];
    let words = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    match event["method"].as_str()? {
        "Runtime.exceptionThrown" => {
            let details = &of["exceptionDetails"];
            let thrown = details["exception"]["description"].as_str();
            Some(format!("JavaScript exception: {}", thrown.map_or_else(|| words(&details["text"]), str::to_owned)))
        }
        "Runtime.consoleAPICalled" if of["type"] == "error" || of["type"] == "assert" => {
            let said = of["args"].as_array()?.iter().filter_map(|argument| Some(argument.get("value")?.to_string()));
            Some(format!("console error: {}", said.collect::<Vec<_>>().join(" ")))
        }
        "Log.entryAdded" if of["entry"]["level"] == "error" => {
            Some(format!("browser's log: {}", words(&of["entry"]["text"])))
        }
        "Network.requestWillBeSent" => {
            let url = words(&of["request"]["url"]);
            // What lies below a page in a folder of its own is its own, too.
            let leaves = !url.starts_with(own_url) && !url.starts_with("data:");
            leaves.then(|| format!("request that leaves the file: {url}"))
        }
        _ => None,
    }
}

/// A text of an answer.
fn text(answer: &Value, name: &str) -> Result<String> {
    let found = answer[name].as_str().with_context(|| format!("the browser's answer has no {name}: {answer}"))?;
    Ok(found.to_owned())
}

/// A file of an answer.
fn bytes(answer: &Value) -> Result<Vec<u8>> {
    BASE64_STANDARD.decode(text(answer, "data")?).context("the browser's file is no base64")
}
