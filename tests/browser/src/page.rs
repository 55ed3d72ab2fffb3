//! A page open in the browser, and what it complained of while it loaded.

use std::{
    sync::{
        Arc,
        mpsc::{self, Receiver},
    },
    time::Duration,
};

use anyhow::{Context, Result, bail};
use base64::prelude::{BASE64_STANDARD, Engine as _};
use headless_chrome::{
    Browser, Tab,
    protocol::cdp::{
        Emulation::SetDeviceMetricsOverride,
        Log, Network,
        Page::{CaptureScreenshot, CaptureScreenshotFormatOption},
        Runtime::ConsoleAPICalledEventTypeOption as ConsoleCall,
        types::Event,
    },
};

use crate::layout::Layout;

/// The screen a page is shown on.
#[derive(Debug, Clone, Copy)]
pub struct Viewport {
    /// Width, CSS px.
    pub width: u32,
    /// Height, CSS px.
    pub height: u32,
    /// Device pixels in a CSS px.
    pub scale: f64,
    /// Whether the page is laid out as on a telephone, where it must ask for the screen's own width.
    pub mobile: bool,
    /// The least legible size of text on it, CSS px.
    pub least_text: f64,
}

/// A page in the browser; closed when dropped.
pub struct Page {
    tab: Arc<Tab>,
    troubles: Receiver<Trouble>,
}

enum Trouble {
    Found(String),
    /// Everything before this has been reported.
    End,
}

/// What [`Page::troubles`] has the page log to find the end of what it reported before.
const END: &str = "report-browser-test: end";

impl Page {
    /// Opens a page in a tab of its own and waits until it has settled.
    ///
    /// # Errors
    /// The browser cannot open it.
    pub fn open(browser: &Browser, url: &str, viewport: Viewport) -> Result<Self> {
        let tab = browser.new_tab()?;
        let (sender, troubles) = mpsc::channel();
        let own_url = url.to_owned();
        tab.add_event_listener(Arc::new(move |event: &Event| {
            if let Some(trouble) = trouble(event, &own_url) {
                // Fails only when the page is gone, and with it whoever asks.
                let _ = sender.send(trouble);
            }
        }))?;
        tab.enable_runtime()?;
        tab.enable_log()?;
        tab.call_method(Network::Enable {
            max_total_buffer_size: None,
            max_resource_buffer_size: None,
            max_post_data_size: None,
            report_direct_socket_traffic: None,
            enable_durable_messages: None,
        })?;
        tab.call_method(SetDeviceMetricsOverride {
            width: viewport.width,
            height: viewport.height,
            device_scale_factor: viewport.scale,
            mobile: viewport.mobile,
            scale: None,
            screen_width: None,
            screen_height: None,
            position_x: None,
            position_y: None,
            dont_set_visible_size: None,
            screen_orientation: None,
            viewport: None,
            display_feature: None,
            device_posture: None,
        })?;
        tab.navigate_to(url)?.wait_until_navigated()?;
        Ok(Self { tab, troubles })
    }

    /// Measures the page.
    ///
    /// # Errors
    /// The browser's.
    pub(crate) fn layout(&self) -> Result<Layout> {
        let answer = self.tab.evaluate(include_str!("layout.js"), true)?;
        let Some(serde_json::Value::String(json)) = answer.value else {
            bail!("layout.js failed: {}", answer.description.unwrap_or_default());
        };
        serde_json::from_str(&json).context("layout.js and layout.rs disagree")
    }

    /// Exceptions, errors on the console, and requests for anything beyond the page itself, up to now.
    ///
    /// # Errors
    /// The browser's.
    pub fn troubles(&self) -> Result<Vec<String>> {
        self.tab.evaluate(&format!("console.debug('{END}')"), false)?;
        let mut found = Vec::new();
        loop {
            match self.troubles.recv_timeout(Duration::from_secs(20)).context("the browser fell silent")? {
                Trouble::Found(trouble) => found.push(trouble),
                Trouble::End => return Ok(found),
            }
        }
    }

    /// The whole page as a PNG image, beyond the screen's lower edge too.
    ///
    /// # Errors
    /// The browser's.
    pub fn screenshot(&self) -> Result<Vec<u8>> {
        let shot = self.tab.call_method(CaptureScreenshot {
            format: Some(CaptureScreenshotFormatOption::Png),
            quality: None,
            clip: None,
            from_surface: Some(true),
            capture_beyond_viewport: Some(true),
            optimize_for_speed: None,
        })?;
        BASE64_STANDARD.decode(shot.data).context("the screenshot is no base64")
    }

    /// The page as printed.
    ///
    /// # Errors
    /// The browser's.
    pub fn pdf(&self) -> Result<Vec<u8>> {
        self.tab.print_to_pdf(None)
    }
}

impl Drop for Page {
    fn drop(&mut self) {
        // Fails only when the browser is gone already.
        let _ = self.tab.close(false);
    }
}

fn trouble(event: &Event, own_url: &str) -> Option<Trouble> {
    let found = match event {
        Event::RuntimeExceptionThrown(event) => {
            let details = &event.params.exception_details;
            let thrown = details.exception.as_ref().and_then(|thrown| thrown.description.as_deref());
            format!("JavaScript exception: {}", thrown.unwrap_or(&details.text))
        }
        Event::RuntimeConsoleAPICalled(event) => {
            let said: Vec<String> =
                event.params.args.iter().filter_map(|argument| Some(argument.value.as_ref()?.to_string())).collect();
            match event.params.Type {
                ConsoleCall::Debug if said == [format!("\"{END}\"")] => return Some(Trouble::End),
                ConsoleCall::Error | ConsoleCall::Assert => format!("console error: {}", said.join(" ")),
                _ => return None,
            }
        }
        Event::LogEntryAdded(event) if event.params.entry.level == Log::LogEntryLevel::Error => {
            format!("browser's log: {}", event.params.entry.text)
        }
        Event::NetworkRequestWillBeSent(event) => {
            let url = &event.params.request.url;
            if url == own_url || url.starts_with("data:") {
                return None;
            }
            format!("request that leaves the file: {url}")
        }
        _ => return None,
    };
    Some(Trouble::Found(found))
}
