(() => {
  const $ = (id) => document.getElementById(id);
  const map = $("map"), slider = $("time"), T = RUN.t;
  const scale = +map.dataset.scale, x0 = +map.dataset.x0, y0 = +map.dataset.y0;
  const px = (x, y) => [x0 + scale * x, y0 - scale * y];
  const mmss = (t) => { const s = Math.round(t); return `${Math.floor(s / 60)}:${String(s % 60).padStart(2, "0")}`; };
  const all = (query) => [...document.querySelectorAll(query)];
  const track = ["track", "track-edge"].map($).filter(Boolean);

  // Length of the drawn path up to every sample, so that the travelled part shows by a dash.
  function travelled(xs, ys, line) {
    const lengths = [0];
    for (let i = 1; i < xs.length; i++) {
      const [ax, ay] = px(xs[i - 1], ys[i - 1]), [bx, by] = px(xs[i], ys[i]);
      lengths.push(lengths[i - 1] + Math.hypot(bx - ax, by - ay));
    }
    const drawn = line ? line.getTotalLength() / (lengths[lengths.length - 1] || 1) : 1;
    return lengths.map((length) => length * drawn);
  }
  const lengths = travelled(RUN.x, RUN.y, track[0]);

  const before = (times, t) => {  // last index with times[i] <= t, at least 0
    let low = 0, high = times.length - 1;
    while (low < high) { const mid = (low + high + 1) >> 1; if (times[mid] <= t + 1e-6) low = mid; else high = mid - 1; }
    return low;
  };
  const frameTimes = RUN.frames.map((f) => f.t), asked = RUN.decisions.map((d) => d.t), told = RUN.chains.map(([at]) => at);
  const charts = all("svg.timed").map((svg) => ({ svg, line: svg.querySelector(".cursor") }));
  const [plotLeft, plotRight, plotWidth] = RUN.plot;
  const chartX = (t) => plotLeft + (t / (RUN.end || 1)) * (plotRight - plotLeft);
  let shownDecision = null, shownChain = null;

  const put = (id, text) => { if ($(id)) $(id).textContent = text; };
  const esc = (s) => String(s).replace(/[&<>"]/g, (c) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" }[c]));

  function centroids(chain) {
    const spots = chain.map(([, x, y]) => px(x, y).map((v) => v.toFixed(1)));
    $("layer-centroids").innerHTML =
      `<polyline class="chain" points="${spots.map((p) => p.join()).join(" ")}"/>` +
      chain.map(([index, , , visited], k) => `<circle r="6" cx="${spots[k][0]}" cy="${spots[k][1]}" class="centroid${visited ? " visited" : ""}"/>` +
        `<text class="centroidname" x="${+spots[k][0] + 10}" y="${spots[k][1] - 7}">${esc(index)}</text>`).join("");
  }

  function show(t) {
    t = Math.max(0, Math.min(RUN.end, t));
    slider.value = t;
    put("clock", mmss(t)); put("now-clock", mmss(t));
    const x = chartX(t);
    for (const c of charts) { c.line.setAttribute("x1", x); c.line.setAttribute("x2", x); }
    if (T.length) {
      const i = before(T, t), j = Math.min(i + 1, T.length - 1);
      const w = T[j] > T[i] ? Math.min(1, Math.max(0, (t - T[i]) / (T[j] - T[i]))) : 0;
      const mix = (v) => v[i] + w * (v[j] - v[i]);
      if ($("robot")) {
        const a = RUN.a, turn = a[i] + w * Math.atan2(Math.sin(a[j] - a[i]), Math.cos(a[j] - a[i]));
        const [rx, ry] = px(mix(RUN.x), mix(RUN.y));
        $("robot").setAttribute("transform", `translate(${rx.toFixed(1)},${ry.toFixed(1)}) rotate(${(-turn * 180 / Math.PI).toFixed(1)})`);
      }
      for (const p of track) p.style.strokeDasharray = t >= RUN.end ? "none" : `${mix(lengths)} 1e6`;
      put("now-coverage", RUN.k[i] == null ? "–" : `${Math.round(100 * RUN.k[i])} %`);
      put("now-speed", RUN.s[i] == null ? "–" : `${RUN.s[i].toFixed(2)} m/s`);
      put("now-clearance", RUN.c[i] == null ? "–" : RUN.c[i] > 99 ? "open" : `${RUN.c[i].toFixed(2)} m`);
      const goal = $("goalmark");
      if (RUN.gx[i] == null) goal.setAttribute("visibility", "hidden");
      else { goal.setAttribute("visibility", "visible"); goal.setAttribute("transform", `translate(${px(RUN.gx[i], RUN.gy[i]).map((v) => v.toFixed(1))})`); }
    }
    if (RUN.frames.length) {
      const f = RUN.frames[before(frameTimes, t)];
      if (f.map && $("cells")) $("cells").setAttribute("href", f.map);
      if (f.rgb) $("now-rgb").src = f.rgb;
      if (f.seg) $("now-seg").src = f.seg;
      if (f.dep) $("now-dep").src = f.dep;
    }
    const k = told.length && told[0] <= t + 1e-6 ? before(told, t) : -1;
    if (k !== shownChain) { shownChain = k; centroids(k < 0 ? [] : RUN.chains[k][1]); }
    const n = asked.length && asked[0] <= t + 1e-6 ? before(asked, t) : -1;
    if (n !== shownDecision) {
      shownDecision = n;
      all(".map .decision").forEach((g) => { g.classList.toggle("on", n >= 0 && +g.dataset.decision === RUN.decisions[n].n); g.classList.toggle("later", n < 0 || +g.dataset.decision > RUN.decisions[n].n); });
      all(".link,.ask").forEach((l) => l.classList.toggle("on", n >= 0 && +l.dataset.decision === RUN.decisions[n].n));
      if (n < 0) $("now-decision").textContent = "No decision yet.";
    }
    if (n >= 0) {
      const d = RUN.decisions[n], open = t < d.end || d.verdict === "open";
      const state = open ? "thinking" : "done";
      const box = $("now-decision");
      if (box.dataset.key !== d.n + state) {
        box.dataset.key = d.n + state;
        box.innerHTML = `<b>Decision ${d.n}</b>, asked at ${mmss(d.t)} <span class="chip">${esc(d.cause || "asked")}</span> <span class="chip soft">${esc(d.mode)}</span>` +
          (open ? "<p>The advisor is thinking; the robot keeps moving.</p>" : `<p><b>${esc(d.said)}</b> <span class="chip ${esc(d.verdict)}">${esc(d.verdict)}${d.tries > 1 ? ` after ${d.tries} tries` : ""}</span></p><p>${esc(d.why)}</p>`) +
          `<p><a href="#decision-${d.n}" data-open="${d.n}">pictures and verdicts ↓</a></p>`;
      }
    }
  }

  function select(number) {
    const d = RUN.decisions.find((one) => one.n === +number);
    if (!d) return;
    stop();
    show(d.verdict === "open" ? d.t : Math.max(d.t, d.end));
    // A re-query may outlast the next question; the card follows the click.
    if (RUN.decisions[shownDecision] !== d) show(d.t);
    all("details.decision").forEach((e) => e.classList.toggle("on", e.id === `decision-${d.n}`));
  }

  let timer = 0, last = 0;
  const stop = () => { cancelAnimationFrame(timer); timer = 0; $("play").textContent = "▶"; };
  const tick = (now) => {
    const t = +slider.value + Math.min(0.1, (now - last) / 1000) * +$("rate").value;
    last = now;
    show(t);
    if (t >= RUN.end) stop(); else timer = requestAnimationFrame(tick);
  };
  $("play").onclick = () => {
    if (timer) return stop();
    if (+slider.value >= RUN.end - 0.05) show(0);
    $("play").textContent = "❚❚"; last = performance.now(); timer = requestAnimationFrame(tick);
  };
  slider.oninput = () => { stop(); show(+slider.value); };
  charts.forEach(({ svg }) => svg.addEventListener("click", (e) => {
    const number = e.target.closest("[data-decision]")?.dataset.decision;
    if (number) return select(number);
    const box = svg.getBoundingClientRect();
    stop(); show((((e.clientX - box.left) / box.width) * plotWidth - plotLeft) / (plotRight - plotLeft) * RUN.end);
  }));
  all(".map .decision").forEach((g) => { g.onclick = () => select(g.dataset.decision); g.onkeydown = (e) => { if (e.key === "Enter" || e.key === " ") { e.preventDefault(); select(g.dataset.decision); } }; });
  all(".seek").forEach((b) => { b.onclick = (e) => { e.preventDefault(); select(b.dataset.decision); $("survey").scrollIntoView(); }; });
  all(".layers input").forEach((box) => { box.onchange = () => { for (const id of [box.dataset.layer, ...({ decisions: ["links"], truth: ["truenames"] }[box.dataset.layer] || [])]) $(`layer-${id}`).style.display = box.checked ? "" : "none"; }; });
  document.addEventListener("click", (e) => {
    const link = e.target.closest && e.target.closest("[data-open]");
    if (link) $(`decision-${link.dataset.open}`).open = true;
    if (e.target.matches(".shown img")) e.target.parentElement.classList.toggle("big");
  });
  if ($("unfold")) $("unfold").onclick = () => { const shut = all("details.decision").some((d) => !d.open); all("details.decision").forEach((d) => { d.open = shut; }); $("unfold").textContent = shut ? "fold all" : "unfold all"; };
  // One picture may have been shown many times; the page holds it once.
  all("[data-picture]").forEach((img) => { img.src = RUN.pictures[img.dataset.picture]; });
  let folded = [];
  addEventListener("beforeprint", () => { stop(); show(RUN.end); folded = all("details:not([open])"); folded.forEach((d) => { d.open = true; }); });
  addEventListener("afterprint", () => folded.forEach((d) => { d.open = false; }));
  show(RUN.end);
})();
