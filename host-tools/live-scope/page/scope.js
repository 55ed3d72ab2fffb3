// The page: it draws what comes as events, and asks for what its buttons say.
(() => {
  const KEPT = 60, DRAWS_EVERY = 50;
  const at = (id) => document.getElementById(id);
  const colours = { ink: "#16191c", soft: "#565c62", line: "#e7e9eb", estimate: "#0060a8", error: "#c8500a", sensor: "#70757a", band: "#0060a82e" };
  let history = new History(0.005, KEPT), hasSensor = false, hasInterval = false, paused = false, recording = false, dirty = false, plots = [];

  const number = (value, digits) => (value === null || value === undefined ? "–" : value.toFixed(digits).replace("-", "−"));
  const say = (text, refused) => {
    at("said").textContent = text;
    at("said").classList.toggle("refused", refused);
  };

  // Plots.
  const padded = (least, largest) => (least === null || least === undefined ? [0, 1] : uPlot.rangeNum(least, largest, 0.1, true));
  const axis = (size) => ({ stroke: colours.soft, font: "12px system-ui, sans-serif", size, grid: { stroke: colours.line, width: 1 }, ticks: { stroke: colours.line, width: 1 } });
  const curve = (stroke, width) => ({ stroke, width, points: { show: false } });
  // A quantity is drawn as its least and its largest, with what lies between filled.
  const quantity = (colour, width) => [curve(colour, width), curve(colour, width)];
  const hidden = () => [curve("transparent", 0), curve("transparent", 0)];
  const plot = (id, { series = [], fills = [], x = [0, 1], draw = () => {} }) => {
    const place = at(id);
    const bands = fills.map((fill, index) => ({ series: [2 + 2 * index, 1 + 2 * index], fill }));
    // What is shown, where it is not all that there is.
    const view = { across: null, up: null };
    const made = new uPlot({
      width: place.clientWidth, height: place.clientHeight, padding: [8, 12, 0, 0],
      cursor: { show: false }, legend: { show: false }, select: { show: false },
      scales: { x: { time: false, range: () => view.across ?? x }, y: { range: (_, least, largest) => view.up ?? padded(least, largest) } },
      axes: [axis(32), axis(64)], series: [{}, ...series], bands, hooks: { draw: [draw] },
    }, [[0, 1], ...series.map(() => [null, null])], place);
    // A canvas is no text: what it shows stands in its caption.
    place.querySelector("canvas").setAttribute("aria-hidden", "true");
    made.view = view;
    return made;
  };
  const loop = (made) => {
    const { ctx } = made;
    ctx.save();
    ctx.beginPath();
    ctx.rect(made.bbox.left, made.bbox.top, made.bbox.width, made.bbox.height);
    ctx.clip();
    ctx.beginPath();
    for (const piece of made.pieces ?? []) {
      for (let index = 0; index < piece.length; index += 2) {
        const [x, y] = [made.valToPos(piece[index], "x", true), made.valToPos(piece[index + 1], "y", true)];
        if (index) ctx.lineTo(x, y); else ctx.moveTo(x, y);
      }
    }
    ctx.strokeStyle = colours.estimate;
    ctx.lineWidth = 1.5 * devicePixelRatio;
    ctx.lineJoin = "round";
    ctx.stroke();
    ctx.restore();
  };
  const make = () => {
    for (const made of plots) made.destroy();
    const [thick, thin] = [3, 1.5];
    plots = [
      plot("displacements", { series: [...hidden(), ...quantity(colours.sensor, thick), ...quantity(colours.estimate, thin)], fills: [colours.band, colours.sensor, colours.estimate] }),
      plot("over-time", { series: quantity(colours.ink, thin), fills: [colours.ink] }),
      plot("loop", { draw: loop }),
    ];
    if (hasSensor) plots.push(plot("errors", { series: [...hidden(), ...quantity(colours.error, thin)], fills: [colours.band, colours.error] }));
    dirty = true;
  };
  const extent = (pieces, offset) => {
    let [least, largest] = [Infinity, -Infinity];
    for (const piece of pieces) {
      for (let index = offset; index < piece.length; index += 2) {
        least = Math.min(least, piece[index]);
        largest = Math.max(largest, piece[index]);
      }
    }
    return least <= largest ? padded(least, largest) : [0, 1];
  };
  const LOOP = 2;
  const draw = () => {
    const span = Number(at("span").value), start = Math.max(history.first, history.last - span);
    const merged = history.merged(start, plots[0].bbox.width / devicePixelRatio);
    const negative = merged.halfWidth.map((half) => (half === null ? null : -half));
    const data = [
      [...merged.interval, ...merged.sensor, ...merged.displacement],
      merged.voltage,
      [],
      [negative, merged.halfWidth, ...merged.error],
    ];
    plots.forEach((made, index) => {
      if (index === LOOP) {
        made.pieces = history.pieces(start);
        [made.view.across, made.view.up] = [extent(made.pieces, 0), extent(made.pieces, 1)];
        made.setData([made.view.across]);
      } else {
        made.view.across = [start, start + span];
        made.setData([merged.seconds, ...data[index]]);
      }
    });
    // What is drawn, for tests of the page.
    window.scope = { history, merged, drawn: (window.scope?.drawn ?? 0) + 1 };
  };
  let before = 0;
  const turn = (now) => {
    if (dirty && !paused && now - before >= DRAWS_EVERY && !document.hidden) {
      [dirty, before] = [false, now];
      draw();
    }
    requestAnimationFrame(turn);
  };
  new ResizeObserver(() => {
    for (const made of plots) {
      const { clientWidth: width, clientHeight: height } = made.root.parentElement;
      if (width !== made.width || height !== made.height) made.setSize({ width, height });
    }
    dirty = true;
  }).observe(document.querySelector("main"));

  // What comes.
  const device = (facts) => {
    history = new History(facts.column_s, KEPT);
    [hasSensor, hasInterval] = [facts.sensor, facts.interval];
    document.querySelectorAll(".sensor").forEach((element) => { element.hidden = !hasSensor; });
    at("board").textContent = `${facts.board}: ${facts.table}`;
    document.title = `piezo monitor: ${facts.board}`;
    at("zero-button").disabled = facts.no_zero !== null;
    if (facts.no_zero !== null) say(facts.no_zero, true);
    make();
  };
  const words = (state) => {
    const none = state.voltage_v === null ? "waiting for samples …" : "all is well";
    const list = state.gone ? [{ what: state.gone, fault: true }] : state.words;
    const items = (list.length ? list : [{ what: none }]).map(({ what, remedy }) => {
      const item = document.createElement("li");
      item.append(what);
      if (remedy) {
        const small = document.createElement("small");
        small.append(`→ ${remedy}`);
        item.append(small);
      }
      return item;
    });
    at("words").replaceChildren(...items);
    at("words").className = list.some(({ fault }) => fault) ? "fault" : list.length ? "careful" : "";
  };
  const state = (of) => {
    const [y, v] = [of.displacement_um, of.voltage_v];
    at("displacement").textContent = number(y?.[0], 3);
    const half = of.half_width_um;
    at("interval").textContent = !y || !hasInterval ? "" : half === null ? "no ± yet: zero it" : `± ${number(half, 3)} µm`;
    at("lately").textContent = y ? `last second ${number(y[1], 3)} … ${number(y[2], 3)} µm` : "";
    at("voltage").textContent = number(v?.[0], 4);
    at("voltages").textContent = v ? `last second ${number(v[1], 4)} … ${number(v[2], 4)} V` : "";
    at("sensor").textContent = number(of.sensor_um, 3);
    at("error").textContent = of.error_um === null ? "" : `estimate less sensor ${number(of.error_um, 3)} µm`;
    document.querySelectorAll(".interval").forEach((element) => { element.hidden = half === null; });
    words(of);
    const part = of.every > 1 ? ` (one of ${of.every} ticks)` : "";
    at("rate").textContent = of.gone ? "" : `${of.rate.toFixed(0)} samples a second${part},`;
    at("lost").textContent = of.gone ? "" : `${of.lost} lost.`;
    at("lost").className = of.lost ? "lost" : "";
    at("mode").textContent = of.gone ? "" : `The device ${of.mode}; ${of.bias}.`;
    recording = of.recording !== null;
    at("record").textContent = recording ? "Stop recording" : "Record";
    at("record").classList.toggle("on", recording);
    at("recorded").textContent = recording ? `recording into ${of.recording.file}: ${of.recording.seconds.toFixed(1)} s` : of.recorded ?? "";
  };
  const events = new EventSource("events");
  const on = (name, take) => events.addEventListener(name, ({ data }) => take(JSON.parse(data)));
  on("device", device);
  on("state", state);
  on("columns", ({ columns, points }) => {
    history.push(columns, points);
    dirty = true;
  });
  events.onerror = () => {
    at("words").className = "fault";
    at("words").textContent = "piezo monitor does not answer: has it ended? Start it again and open the address that it prints";
  };

  // What the buttons ask for.
  const ask = async (what, body) => {
    try {
      const answer = await fetch(what, { method: "POST", body: JSON.stringify(body) });
      const said = await answer.text();
      // What becomes of a recording is part of the state.
      say(what === "record" && answer.ok ? "" : said, !answer.ok);
    } catch {
      say("piezo monitor does not answer", true);
    }
  };
  at("zero").addEventListener("submit", (event) => {
    event.preventDefault();
    ask("zero", { at_um: at("at").valueAsNumber });
  });
  at("record").addEventListener("click", () => ask("record", { on: !recording }));
  at("pause").addEventListener("click", () => {
    paused = !paused;
    dirty = true;
    at("pause").textContent = paused ? "Go on drawing" : "Pause the drawing";
    at("pause").classList.toggle("on", paused);
  });
  at("span").addEventListener("change", () => { dirty = true; });
  make();
  requestAnimationFrame(turn);
})();
