//! A headless Chromium for tests of pages, driven over WebDriver.
//!
//! `chromedriver` is started on a port that it chooses itself; everything else is JSON over HTTP.
//! The session and the driver end when the [`Browser`] is dropped.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, ChildStdout, Command, Stdio};
use std::time::Duration;

use serde_json::{Value, json};
use ureq::Agent;

/// A running browser with one page.
pub struct Browser {
    driver: Child,
    /// What the driver prints; closed, it would stop the driver.
    _output: BufReader<ChildStdout>,
    agent: Agent,
    /// Address of the session; commands are below it.
    session: String,
}

impl Browser {
    /// Starts one. `None` where Chromium or its driver is not installed: then it says what is
    /// skipped, and with `CI` set that is a failure.
    pub fn start(skipped: &str) -> Option<Browser> {
        let Some(binary) = ["chromium", "chromium-browser", "google-chrome"]
            .into_iter()
            .find(is_there)
        else {
            return missing("chromium", skipped);
        };
        if !is_there(&"chromedriver") {
            return missing("chromedriver (Debian: chromium-driver)", skipped);
        }
        let mut driver = Command::new("chromedriver")
            .arg("--port=0")
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("chromedriver starts");
        let mut output = BufReader::new(driver.stdout.take().expect("it is piped"));
        let port = (&mut output)
            .lines()
            .map_while(Result::ok)
            .find_map(|line| {
                let (_, port) = line.split_once("successfully on port ")?;
                port.trim_end_matches('.').parse::<u16>().ok()
            })
            .expect("chromedriver says on which port it listens");
        // Slow machines take their time; and whatever stands in the environment, no proxy.
        let config = Agent::config_builder()
            .timeout_global(Some(Duration::from_secs(120)))
            .http_status_as_error(false)
            .proxy(None)
            .build();
        let mut browser = Browser {
            driver,
            _output: output,
            agent: config.into(),
            session: format!("http://127.0.0.1:{port}/session"),
        };
        let options = json!({
            "binary": binary_path(binary),
            "args": ["--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--disable-gpu"],
        });
        let wanted = json!({ "capabilities": { "alwaysMatch": {
            "goog:chromeOptions": options,
            "goog:loggingPrefs": { "browser": "ALL", "performance": "ALL" },
        } } });
        let session = browser.post("", &wanted);
        let id = session["sessionId"].as_str().expect("a session has an id");
        browser.session = format!("{}/{id}", browser.session);
        Some(browser)
    }

    /// The size of the page, in CSS pixels.
    pub fn resize(&self, width: u32, height: u32) {
        let size = json!({
            "width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500,
        });
        self.devtools("Emulation.setDeviceMetricsOverride", &size);
    }

    /// What `prefers-color-scheme` says: `light` or `dark`.
    pub fn prefer(&self, scheme: &str) {
        let feature = json!({ "name": "prefers-color-scheme", "value": scheme });
        self.devtools(
            "Emulation.setEmulatedMedia",
            &json!({ "features": [feature] }),
        );
    }

    /// Opens a file and waits until it is loaded.
    pub fn open(&self, file: &Path) {
        let file = file.canonicalize().expect("the page is there");
        self.post(
            "/url",
            &json!({ "url": format!("file://{}", file.display()) }),
        );
    }

    /// What a script returns (`return …`).
    pub fn run(&self, script: &str) -> Value {
        self.post("/execute/sync", &json!({ "script": script, "args": [] }))
    }

    /// The visible part of the page, as PNG in base 64.
    pub fn screenshot(&self) -> String {
        let picture = self.get("/screenshot");
        picture.as_str().expect("a picture is text").to_string()
    }

    /// Complaints on the console since the last call.
    pub fn complaints(&self) -> Vec<String> {
        let entries = self.post("/se/log", &json!({ "type": "browser" }));
        let entries = entries.as_array().expect("a list").iter();
        entries
            .filter(|e| e["level"] != "INFO" && e["level"] != "DEBUG")
            .map(|e| e["message"].to_string())
            .collect()
    }

    /// Addresses that were asked for since the last call; `data:` ones are not.
    pub fn requests(&self) -> Vec<String> {
        let entries = self.post("/se/log", &json!({ "type": "performance" }));
        let entries = entries.as_array().expect("a list").iter();
        entries
            .filter_map(|e| serde_json::from_str::<Value>(e["message"].as_str()?).ok())
            .filter(|e| e["message"]["method"] == "Network.requestWillBeSent")
            .filter_map(|e| {
                Some(
                    e["message"]["params"]["request"]["url"]
                        .as_str()?
                        .to_string(),
                )
            })
            .filter(|url| !url.starts_with("data:"))
            .collect()
    }

    fn devtools(&self, command: &str, parameters: &Value) -> Value {
        let body = json!({ "cmd": command, "params": parameters });
        self.post("/goog/cdp/execute", &body)
    }

    fn post(&self, command: &str, body: &Value) -> Value {
        let answer = self
            .agent
            .post(format!("{}{command}", self.session))
            .send_json(body);
        let mut answer = answer.unwrap_or_else(|e| panic!("{command}: {e}"));
        value(command, answer.body_mut().read_json())
    }

    fn get(&self, command: &str) -> Value {
        let answer = self.agent.get(format!("{}{command}", self.session)).call();
        let mut answer = answer.unwrap_or_else(|e| panic!("{command}: {e}"));
        value(command, answer.body_mut().read_json())
    }
}

impl Drop for Browser {
    // Without the first of these the browser would live on.
    fn drop(&mut self) {
        _ = self.agent.delete(&self.session).call();
        _ = self.driver.kill();
        _ = self.driver.wait();
    }
}

fn value(command: &str, answer: Result<Value, ureq::Error>) -> Value {
    let mut answer = answer.unwrap_or_else(|e| panic!("{command}: {e}"));
    let value = answer["value"].take();
    assert!(value["error"].is_null(), "{command}: {value}");
    value
}

fn is_there(program: &&str) -> bool {
    binary_path(program).is_some()
}

fn binary_path(program: &str) -> Option<String> {
    let folders = std::env::var_os("PATH")?;
    let found = std::env::split_paths(&folders)
        .map(|f| f.join(program))
        .find(|p| p.is_file())?;
    Some(found.to_string_lossy().into_owned())
}

fn missing(what: &str, skipped: &str) -> Option<Browser> {
    assert!(std::env::var_os("CI").is_none(), "{what} is not installed");
    println!("{what} is not installed: {skipped} is skipped");
    None
}
