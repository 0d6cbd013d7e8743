//! A headless Chromium, driven over its DevTools protocol: as much of it as a page's test needs.

use base64::Engine;
use serde_json::{Value, json};
use std::io::Write;
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tungstenite::stream::MaybeTlsStream;
use tungstenite::{Message, WebSocket};

/// The longest wait for the browser, at its start and for each answer: a loaded machine of two cores stays below it.
const PATIENCE: Duration = Duration::from_secs(120);

/// Set where a browser must be there, as in CI: then a test without one fails.
const NEEDED: &str = "ISOPHOTE_NEED_BROWSER";

/// Whether there is a browser. Where there is none, says plainly that `test`, `which` of the tests that need one, does
/// not run: straight to standard error, since what a passing test prints is not shown.
pub fn is_there(test: &str, which: &str) -> bool {
    let there = Command::new("chromium").arg("--version").output().is_ok_and(|output| output.status.success());
    if !there {
        assert!(std::env::var_os(NEEDED).is_none(), "{NEEDED} is set, and there is no chromium");
        let line = format!("NOT RUN: browser::{test} (browser test {which}): no chromium here; CI runs it\n");
        std::io::stderr().write_all(line.as_bytes()).expect("standard error takes a line");
    }
    there
}

/// A page in a browser of its own.
pub struct Page {
    browser: Child,
    profile: PathBuf,
    socket: WebSocket<MaybeTlsStream<TcpStream>>,
    session: String,
    sent: u64,
    /// Errors that the page raised or logged, and addresses that it fetched.
    pub complaints: Vec<String>,
}

impl Page {
    /// Starts a browser with a window of that size, its profile in `profile`, and opens a file.
    pub fn open(file: &Path, profile: PathBuf, size: [u32; 2]) -> Self {
        Self::open_with(&["--disable-gpu"], file, profile, size)
    }

    /// The same with these flags besides.
    pub fn open_with(flags: &[&str], file: &Path, profile: PathBuf, size: [u32; 2]) -> Self {
        let browser = Command::new("chromium")
            .args(["--headless=new", "--no-sandbox", "--hide-scrollbars", "--no-first-run"])
            .args(flags)
            .args(["--disable-dev-shm-usage", "--remote-debugging-port=0"])
            .arg(format!("--window-size={},{}", size[0], size[1]))
            .arg(format!("--user-data-dir={}", profile.display()))
            .arg("about:blank")
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("chromium: `apt-get install chromium`");
        let started = Instant::now();
        let address = loop {
            let found = std::fs::read_to_string(profile.join("DevToolsActivePort")).unwrap_or_default();
            if let Some((port, path)) = found.split_once('\n').filter(|(_, path)| !path.is_empty()) {
                break format!("ws://127.0.0.1:{port}{}", path.trim());
            }
            assert!(started.elapsed() < PATIENCE, "the browser did not start");
            std::thread::sleep(Duration::from_millis(50));
        };
        let (socket, _) = tungstenite::connect(address).expect("the browser listens");
        if let MaybeTlsStream::Plain(stream) = socket.get_ref() {
            stream.set_read_timeout(Some(PATIENCE)).expect("a timeout above zero");
        }
        let mut page = Self { browser, profile, socket, session: String::new(), sent: 0, complaints: vec![] };
        let target = page.call("Target.createTarget", json!({"url": "about:blank"}))["targetId"].clone();
        let attached = page.call("Target.attachToTarget", json!({"targetId": target, "flatten": true}));
        page.session = attached["sessionId"].as_str().expect("a session").to_owned();
        for domain in ["Page", "Runtime", "Log", "Network"] {
            page.call(&format!("{domain}.enable"), json!({}));
        }
        page.resize(size);
        page.call("Page.navigate", json!({"url": format!("file://{}", file.display())}));
        while page.evaluate("document.readyState") != "complete" {
            assert!(started.elapsed() < PATIENCE, "the page did not load");
            std::thread::sleep(Duration::from_millis(20));
        }
        page
    }

    /// Gives the page a window of that size.
    pub fn resize(&mut self, [width, height]: [u32; 2]) {
        let metrics = json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": false});
        self.call("Emulation.setDeviceMetricsOverride", metrics);
    }

    /// The value of an expression; an exception is a failed test.
    pub fn evaluate(&mut self, expression: &str) -> Value {
        let asked = json!({"expression": expression, "returnByValue": true, "awaitPromise": true});
        let answer = self.call("Runtime.evaluate", asked);
        assert!(answer.get("exceptionDetails").is_none(), "{expression}: {answer}");
        answer["result"]["value"].clone()
    }

    /// Chooses files in the input that a selector finds.
    pub fn choose(&mut self, selector: &str, files: &[PathBuf]) {
        let root = self.call("DOM.getDocument", json!({}))["root"]["nodeId"].clone();
        let found = self.call("DOM.querySelector", json!({"nodeId": root, "selector": selector}));
        self.call("DOM.setFileInputFiles", json!({"nodeId": found["nodeId"], "files": files}));
    }

    /// Presses and releases a key, which types `text`, on what has the focus.
    pub fn press(&mut self, key: &str, code: u32, text: &str) {
        for kind in ["keyDown", "keyUp"] {
            let event = json!({"type": kind, "key": key, "code": key, "windowsVirtualKeyCode": code, "text": text});
            self.call("Input.dispatchKeyEvent", event);
        }
    }

    /// Writes a picture of the window.
    pub fn screenshot(&mut self, path: &Path) {
        let answer = self.call("Page.captureScreenshot", json!({"format": "png"}));
        let data = answer["data"].as_str().expect("a picture");
        let bytes = base64::engine::general_purpose::STANDARD.decode(data).expect("base64");
        std::fs::write(path, bytes).expect("a file can be written");
    }

    fn call(&mut self, method: &str, params: Value) -> Value {
        self.sent += 1;
        let mut request = json!({"id": self.sent, "method": method, "params": params});
        if !self.session.is_empty() {
            request["sessionId"] = json!(self.session);
        }
        self.socket.send(Message::text(request.to_string())).expect("the browser listens");
        loop {
            let message = self.socket.read().unwrap_or_else(|error| panic!("{method}: no answer: {error}"));
            let Message::Text(text) = message else { continue };
            let message: Value = serde_json::from_str(&text).expect("JSON");
            if message["id"] == json!(self.sent) {
                assert!(message.get("error").is_none(), "{method}: {message}");
                return message["result"].clone();
            }
            self.note(&message);
        }
    }

    fn note(&mut self, event: &Value) {
        let params = &event["params"];
        let complaint = match event["method"].as_str() {
            Some("Runtime.exceptionThrown") => Some(params["exceptionDetails"].to_string()),
            Some("Runtime.consoleAPICalled") if params["type"] == "error" || params["type"] == "warning" => {
                Some(params["args"].to_string())
            }
            Some("Log.entryAdded") if params["entry"]["level"] == "error" => Some(params["entry"].to_string()),
            Some("Network.requestWillBeSent") => {
                let url = params["request"]["url"].as_str().unwrap_or_default();
                let inside = ["file:", "data:", "about:", "blob:"].iter().any(|scheme| url.starts_with(scheme));
                (!inside).then(|| format!("fetched {url}"))
            }
            _ => None,
        };
        self.complaints.extend(complaint);
    }
}

impl Drop for Page {
    fn drop(&mut self) {
        let _ = self.browser.kill();
        let _ = self.browser.wait();
        let _ = std::fs::remove_dir_all(&self.profile);
    }
}
