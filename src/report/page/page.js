// The page of a report. What is visible from where stands in the page's data; this script draws it,
// and finds a line for what is visible. Nothing is asked of the network.
"use strict";
(async () => {
  const facts = JSON.parse(document.getElementById("facts").textContent);
  const $ = (id) => document.getElementById(id);
  const plan = $("plan"), stage = document.querySelector(".stage");
  const n = facts.cells;

  // ---- the data
  const text = atob($("data").textContent.trim());
  const packed = Uint8Array.from(text, (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  const buffer = await new Response(stream).arrayBuffer();
  let at = 0;
  const take = (Type, length) => {
    const list = new Type(buffer, at, length);
    at += list.byteLength;
    return list;
  };
  const vertices = take(Float64Array, 2 * facts.vertices), sight = take(Float64Array, 4 * n);
  const first = take(Uint32Array, n + 1), origin = take(Uint32Array, facts.edges);
  const twin = take(Uint32Array, facts.edges), room = take(Uint32Array, n);
  const measures = {};
  for (const m of facts.measures) measures[m.key] = take(Float32Array, n);
  const growth = facts.growth && take(Float32Array, n);
  const bits = take(Uint8Array, buffer.byteLength - at);
  const WALL = 0xffffffff;
  // Row i of the visible sets starts where the rows of shorter ones end.
  const rows = new Uint32Array(n + 1);
  for (let i = 0; i < n; i++) rows[i + 1] = rows[i] + Math.ceil(i / 8);
  const sees = (a, b) => {
    if (a === b) return true;
    const [i, j] = a > b ? [a, b] : [b, a];
    return (bits[rows[i] + (j >> 3)] >> (j & 7) & 1) === 1;
  };
  const seenFrom = (a) => {
    const list = [];
    for (let b = 0; b < n; b++) if (sees(a, b)) list.push(b);
    return list;
  };
  const cellOf = new Uint32Array(facts.edges);
  for (let c = 0; c < n; c++) cellOf.fill(c, first[c], first[c + 1]);
  const next = (e) => (e + 1 === first[cellOf[e] + 1] ? first[cellOf[e]] : e + 1);
  const start = (e) => [vertices[2 * origin[e]], vertices[2 * origin[e] + 1]];
  const end = (e) => start(next(e));
  const cross = (o, p, q) => (p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0]);
  const edges = (c) => Array.from({ length: first[c + 1] - first[c] }, (_, k) => first[c] + k);
  const middle = (c) => {
    let x = 0, y = 0;
    for (let e = first[c]; e < first[c + 1]; e++) { x += vertices[2 * origin[e]]; y += vertices[2 * origin[e] + 1]; }
    const k = first[c + 1] - first[c];
    return [x / k, y / k];
  };

  // ---- where things are on the plan
  const onPlan = ([x, y]) => [(x - facts.corner[0]) * facts.scale, (facts.corner[1] - y) * facts.scale];
  const inLevel = ([x, y]) => [x / facts.scale + facts.corner[0], facts.corner[1] - y / facts.scale];
  const round = (x) => Math.round(x * 100) / 100;
  const chain = (points) => points.map((p, i) => (i ? "L" : "M") + onPlan(p).map(round).join(" ")).join("");
  const outline = (c) => chain(edges(c).map(start)) + "Z";
  const side = Math.max(1, Math.ceil(Math.sqrt(n)));
  const buckets = Array.from({ length: side * side }, () => []);
  const bucket = (p) => p.map((x, k) => Math.min(side - 1, Math.max(0, Math.floor(x / facts.size[k] * side))));
  for (let c = 0; c < n; c++) {
    const corners = edges(c).map((e) => bucket(onPlan(start(e))));
    const xs = corners.map((p) => p[0]), ys = corners.map((p) => p[1]);
    for (let y = Math.min(...ys); y <= Math.max(...ys); y++)
      for (let x = Math.min(...xs); x <= Math.max(...xs); x++) buckets[y * side + x].push(c);
  }
  const contains = (c, p) => {
    for (let e = first[c]; e < first[c + 1]; e++) if (cross(start(e), end(e), p) < 0) return false;
    return true;
  };
  const cellAt = (p) => {
    const [x, y] = bucket(onPlan(p));
    const found = buckets[y * side + x].find((c) => contains(c, p));
    return found === undefined ? -1 : found;
  };

  // ---- a line between two cells that see each other
  // First by trying: between a few points of both, the line with most room. Narrow sights are sought
  // through chains of portals, depth first, among cells that both see. Of the lines that stab a chain the
  // two extreme ones are kept: `ccw` from a right end to a later left end, `cw` from a left end to a right.
  const extent = Math.max(...facts.size) / facts.scale;
  const EPS = 1e-9 * extent, LEAST = Math.max(facts.step / 2 ** 18, 1e-12 * (extent + Math.hypot(...facts.corner)));
  const through = (p, q) => {
    const dx = q[0] - p[0], dy = q[1] - p[1], l = Math.hypot(dx, dy);
    return [-dy / l, dx / l, (dy * p[0] - dx * p[1]) / l];
  };
  const value = (s, p) => s[0] * p[0] + s[1] * p[1] + s[2];
  const holds = (c, p) => edges(c).every((e) => value(through(start(e), end(e)), p) > LEAST);
  const points = (c) => {
    const m = middle(c), corners = edges(c).map(start), every = Math.ceil(corners.length / 6);
    return [m, ...corners.filter((_, k) => k % every === 0).map((p) => [m[0] + 0.8 * (p[0] - m[0]), m[1] + 0.8 * (p[1] - m[1])])];
  };
  function witness(a, b) {
    if (a === b) return null;
    let best = null;
    for (const p of points(a)) {
      for (const q of points(b)) {
        const line = check(a, b, p, q);
        if (line && (!best || line.room > best.room)) best = line;
      }
    }
    if (best) return best;
    const until = performance.now() + 1500;
    const ma = middle(a), mb = middle(b), course = through(ma, mb);
    const off = (e) => { const p = value(course, start(e)), q = value(course, end(e)); return p * q < 0 ? 0 : Math.min(Math.abs(p), Math.abs(q)); };
    // Of some ends, the one from which a line to `p` has no other on its wanted side.
    const touch = (ends, p, sign) => ends.reduce((best, q) => (sign * cross(best, p, q) > 0 ? q : best));
    const same = (p, q) => p[0] === q[0] && p[1] === q[1];
    const visit = (cell, lefts, rights, ccw, cw, crossed) => {
      if (best || performance.now() > until) return;
      if (cell === b) { best = settle(a, b, lefts, rights, crossed); return; }
      // What lies nearest to the straight way comes first.
      for (const e of edges(cell).sort((p, q) => off(p) - off(q))) {
        if (twin[e] === WALL || crossed.includes(twin[e])) continue;
        const to = cellOf[twin[e]];
        if (!sees(a, to) || !sees(to, b)) continue;
        const right = start(e), left = end(e);
        let nextCcw = ccw, nextCw = cw;
        if (crossed.length === 1) {
          if (!same(rights[0], left)) nextCcw = through(rights[0], left);
          if (!same(lefts[0], right)) nextCw = through(lefts[0], right);
        } else if (crossed.length > 1) {
          // Ends that the portal shares with the one before bound the lines already.
          if (!same(left, lefts[lefts.length - 1]) && value(cw, left) < EPS) continue;
          if (!same(right, rights[rights.length - 1]) && value(ccw, right) > -EPS) continue;
          if (value(ccw, left) < -EPS) nextCcw = through(touch(rights, left, 1), left);
          if (value(cw, right) > EPS) nextCw = through(touch(lefts, right, -1), right);
        }
        visit(to, [...lefts, left], [...rights, right], nextCcw, nextCw, [...crossed, e]);
        if (best) return;
      }
    };
    visit(a, [], [], null, null, []);
    return best;
  }
  const settle = (a, b, lefts, rights, crossed) => {
    if (crossed.length === 1) {
      // Neighbours: through the middle of their portal, from one middle towards the other.
      const e = crossed[0], p = start(e), q = end(e), m = [(p[0] + q[0]) / 2, (p[1] + q[1]) / 2];
      const ma = middle(a), mb = middle(b);
      const inA = [m[0] + (ma[0] - m[0]) / 2, m[1] + (ma[1] - m[1]) / 2];
      const back = [2 * m[0] - inA[0], 2 * m[1] - inA[1]];
      for (let t = 1; t > 1e-6; t /= 2) {
        const to = [m[0] + (back[0] - m[0]) * t, m[1] + (back[1] - m[1]) * t];
        const line = check(a, b, inA, to);
        if (line) return line;
      }
      return check(a, b, ma, mb);
    }
    // Every stabbing line is a sum of lines through two ends that no portal stops; the sum of all of them
    // touches nothing. (Not only lines through a left and a right end: those may all touch the same end.)
    const s = [0, 0, 0];
    const add = (p, q) => {
      if (p[0] === q[0] && p[1] === q[1]) return;
      const line = through(p, q);
      if (lefts.every((x) => value(line, x) > -EPS) && rights.every((x) => value(line, x) < EPS)) line.forEach((x, k) => { s[k] += x; });
    };
    for (let j = 0; j < lefts.length; j++) for (let i = 0; i < j; i++) {
      for (const p of [rights[i], lefts[i]]) for (const q of [rights[j], lefts[j]]) add(p, q);
    }
    const l = Math.hypot(s[0], s[1]);
    if (!(l > 0)) return null;
    const unit = s.map((x) => x / l);
    const from = within(a, unit), to = within(b, unit);
    return from && to && check(a, b, from, to);
  };
  // The middle of what a line has in a cell.
  const within = (c, s) => {
    const met = [];
    for (const e of edges(c)) {
      const p = start(e), q = end(e), f = value(s, p), g = value(s, q);
      if ((f > 0) !== (g > 0)) { const t = f / (f - g); met.push([p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])]); }
    }
    return met.length === 2 ? [(met[0][0] + met[1][0]) / 2, (met[0][1] + met[1][1]) / 2] : null;
  };
  // Walks along a segment from cell to cell; only portals may be crossed, and those between their ends.
  // Nearer than `LEAST` to an end, or to an edge of the cells at its own ends, it might after rounding be
  // on the other side: no such line is shown.
  function check(a, b, from, to) {
    if (!holds(a, from) || !holds(b, to)) return null;
    let cell = a, entry = -1, room = Infinity;
    for (let k = 0; k < 4000; k++) {
      if (cell === b) return room > LEAST ? { from, to, room } : null;
      let exit = -1;
      for (const e of edges(cell)) {
        if (e === entry) continue;
        const f = cross(from, to, start(e)), g = cross(from, to, end(e));
        if (f < 0 && g > 0 && cross(start(e), end(e), to) < 0) exit = e;
      }
      if (exit < 0 || twin[exit] === WALL) return null;
      const length = Math.hypot(to[0] - from[0], to[1] - from[1]);
      room = Math.min(room, -cross(from, to, start(exit)) / length, cross(from, to, end(exit)) / length);
      entry = twin[exit];
      cell = cellOf[entry];
    }
    return null;
  }

  // ---- the way between two cells that do not see each other
  function way(a, b) {
    const dist = new Float64Array(n).fill(Infinity), by = new Int32Array(n).fill(-1), done = new Uint8Array(n);
    const heap = [[0, a]];
    dist[a] = 0;
    const places = new Map([[a, middle(a)]]);
    while (heap.length) {
      let least = 0;
      for (let k = 1; k < heap.length; k++) if (heap[k][0] < heap[least][0]) least = k;
      const [d, c] = heap.splice(least, 1)[0];
      if (done[c]) continue;
      done[c] = 1;
      if (c === b) break;
      for (const e of edges(c)) {
        if (twin[e] === WALL) continue;
        const to = cellOf[twin[e]], p = start(e), q = end(e), m = [(p[0] + q[0]) / 2, (p[1] + q[1]) / 2];
        const here = places.get(c), l = d + Math.hypot(m[0] - here[0], m[1] - here[1]);
        if (l < dist[to]) { dist[to] = l; by[to] = e; places.set(to, m); heap.push([l, to]); }
      }
    }
    if (by[b] < 0) return null;
    const list = [];
    for (let c = b; c !== a; c = cellOf[by[c]]) list.unshift(by[c]);
    const mid = (e) => { const p = start(e), q = end(e); return [(p[0] + q[0]) / 2, (p[1] + q[1]) / 2]; };
    const stop = list.find((e) => !sees(a, cellOf[twin[e]]));
    return { points: [middle(a), ...list.map(mid), middle(b)], stop: stop === undefined ? null : mid(stop), portal: stop };
  }

  // ---- words
  const number = (x) => (Math.abs(x) >= 1000 || Number.isInteger(x) ? Math.round(x).toLocaleString("en") : String(Number(x.toPrecision(4))));
  const nameOf = (c) => `cell ${c} in ${facts.rooms[room[c]]}`;
  const element = (tag, content, parent) => {
    const made = document.createElement(tag);
    if (content !== undefined) made.textContent = content;
    if (parent) parent.append(made);
    return made;
  };
  const withUnit = (m, x) => number(x) + (m.unit ? " " + m.unit : "");
  function tell(title, parts) {
    $("told-title").textContent = title;
    const told = $("told");
    told.replaceChildren();
    for (const part of parts) told.append(part);
  }
  const paragraph = (words) => element("p", words);
  const figures = (c) => {
    const list = document.createElement("dl");
    for (const m of facts.measures) { element("dt", m.title, list); element("dd", withUnit(m, measures[m.key][c]), list); }
    if (growth && !Number.isNaN(growth[c])) { element("dt", "Area since the baseline", list); element("dd", (growth[c] > 0 ? "+" : "") + number(growth[c]), list); }
    return list;
  };

  // ---- what is chosen
  const state = { source: -1, second: -1, seen: [], line: null, hover: -1, cursor: -1 };
  const draw = (id, d) => $(id).setAttribute("d", d);
  const dot = (p, r, stop) => {
    const circle = document.createElementNS("http://www.w3.org/2000/svg", "circle");
    const [x, y] = onPlan(p);
    circle.setAttribute("cx", x); circle.setAttribute("cy", y); circle.setAttribute("r", r * view[2] / facts.size[0]);
    if (stop) circle.setAttribute("class", "stop");
    $("dots").append(circle);
  };
  function clearLines() {
    for (const id of ["sight", "blocked", "second", "gap", "walk"]) draw(id, "");
    $("dots").replaceChildren();
    state.second = -1;
    state.line = null;
  }
  function clear() {
    clearLines();
    for (const id of ["seen", "source"]) draw(id, "");
    state.source = -1;
    state.seen = [];
    stage.classList.remove("chosen");
    tell("Nothing chosen", [paragraph("Choose a cell on the plan, or one of the places below.")]);
  }
  function pick(c) {
    clearLines();
    state.source = c;
    state.seen = seenFrom(c);
    stage.classList.add("chosen");
    draw("seen", state.seen.filter((k) => k !== c).map(outline).join(""));
    draw("source", outline(c));
    const line = [[sight[4 * c], sight[4 * c + 1]], [sight[4 * c + 2], sight[4 * c + 3]]];
    if (line[0][0] !== line[1][0] || line[0][1] !== line[1][1]) {
      draw("sight", chain(line));
      dot(line[1], 4);
    }
    tell(nameOf(c), [figures(c), paragraph("The green line leads from a corner of the cell to the farthest point seen from there. Click a second cell for the sightline between the two.")]);
  }
  function pickSecond(b) {
    const a = state.source;
    clearLines();
    state.second = b;
    draw("second", outline(b));
    if (sees(a, b)) {
      state.line = witness(a, b);
      const words = [];
      if (state.line) {
        const { from, to } = state.line;
        draw("sight", chain([from, to]));
        dot(from, 4); dot(to, 4);
        words.push(paragraph(`The line shown is ${number(Math.hypot(to[0] - from[0], to[1] - from[1]))} ${facts.unit} long and crosses no wall.`));
      } else {
        words.push(paragraph("Sight is too narrow here for the line to be drawn; `enfilade explain` gives it exactly."));
      }
      tell(`Visible: ${nameOf(a)} and ${nameOf(b)}`, [...words, figures(b)]);
    } else {
      const found = way(a, b);
      if (found) {
        draw("blocked", chain(found.points));
        if (found.stop) dot(found.stop, 5, true);
        tell(`Hidden: ${nameOf(b)} from ${nameOf(a)}`, [paragraph("No straight line leads from the one to the other. The dashed way is a short one; at the red dot it leaves what the first cell sees."), figures(b)]);
      } else {
        tell(`Hidden: ${nameOf(b)} from ${nameOf(a)}`, [paragraph("No way leads from the one to the other."), figures(b)]);
      }
    }
  }
  function choose(c) {
    if (c < 0) return clear();
    if (state.source < 0 || state.second >= 0) return pick(c);
    if (c === state.source) return clear();
    pickSecond(c);
  }

  // ---- zoom and pan
  const whole = [0, 0, facts.size[0], facts.size[1]];
  let view = whole.slice();
  const setView = (v) => {
    const w = Math.min(Math.max(v[2], facts.size[0] / 200), facts.size[0]), h = w * facts.size[1] / facts.size[0];
    view = [Math.min(Math.max(v[0], 0), facts.size[0] - w), Math.min(Math.max(v[1], 0), facts.size[1] - h), w, h];
    plan.setAttribute("viewBox", view.map(round).join(" "));
    plan.style.touchAction = w < facts.size[0] ? "none" : "";
  };
  const zoom = (factor, p) => {
    const [x, y] = p || [view[0] + view[2] / 2, view[1] + view[3] / 2];
    setView([x - (x - view[0]) * factor, y - (y - view[1]) * factor, view[2] * factor]);
  };
  const pointer = (event) => {
    const m = plan.getScreenCTM().inverse();
    return [m.a * event.clientX + m.e, m.d * event.clientY + m.f];
  };
  const reveal = (c) => {
    const [x, y] = onPlan(middle(c)), corners = edges(c).map((e) => onPlan(start(e)));
    const reach = Math.max(...corners.map((p) => Math.hypot(p[0] - x, p[1] - y)));
    if (reach * plan.clientWidth < 5 * view[2]) return setView([x - 15 * reach, y - 15 * reach * facts.size[1] / facts.size[0], 30 * reach]);
    if (x < view[0] || x > view[0] + view[2] || y < view[1] || y > view[1] + view[3])
      setView([x - view[2] / 2, y - view[3] / 2, view[2]]);
  };

  // Shows a cell large enough to be clicked.
  const frame = (c) => {
    const corners = edges(c).map((e) => onPlan(start(e))), [x, y] = onPlan(middle(c));
    const reach = Math.max(...corners.map((p) => Math.max(Math.abs(p[0] - x), Math.abs(p[1] - y))));
    const least = Math.min(...edges(c).map((e) => Math.abs(value(through(start(e), end(e)), middle(c))))) * facts.scale;
    const w = Math.min(facts.size[0], Math.max(4 * reach, Math.min(60 * least, 20 * reach)));
    setView([x - w / 2, y - w * facts.size[1] / facts.size[0] / 2, w]);
  };

  // ---- mouse, touch, keys
  const tip = $("tip"), pointers = new Map();
  let drag = null, pinch = 0;
  plan.addEventListener("pointerdown", (event) => {
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    drag = { at: [event.clientX, event.clientY], view: view.slice(), moved: false };
    pinch = 0;
  });
  plan.addEventListener("pointermove", (event) => {
    if (pointers.has(event.pointerId)) pointers.set(event.pointerId, [event.clientX, event.clientY]);
    if (pointers.size === 2) {
      const [p, q] = [...pointers.values()], d = Math.hypot(p[0] - q[0], p[1] - q[1]);
      if (pinch) zoom(pinch / d, pointer({ clientX: (p[0] + q[0]) / 2, clientY: (p[1] + q[1]) / 2 }));
      pinch = d;
      if (drag) drag.moved = true;
    } else if (drag && pointers.size) {
      const dx = event.clientX - drag.at[0], dy = event.clientY - drag.at[1];
      if (Math.hypot(dx, dy) > 5 && view[2] < facts.size[0]) {
        drag.moved = true;
        const k = view[2] / plan.clientWidth;
        setView([drag.view[0] - dx * k, drag.view[1] - dy * k, view[2]]);
      }
    }
    const c = cellAt(inLevel(pointer(event)));
    tip.hidden = c < 0 || event.pointerType === "touch";
    if (c >= 0) {
      const m = facts.measures.find((x) => x.key === $("measure").value) || facts.measures[0];
      if (c !== state.hover) tip.textContent = `${nameOf(c)}: ${m.title.toLowerCase()} ${withUnit(m, measures[m.key][c])}`;
      tip.style.left = Math.min(event.clientX + 14, innerWidth - 290) + "px";
      tip.style.top = event.clientY + 16 + "px";
    }
    state.hover = c;
  });
  const lift = (event) => { pointers.delete(event.pointerId); pinch = 0; };
  plan.addEventListener("pointerup", lift);
  plan.addEventListener("pointercancel", lift);
  plan.addEventListener("pointerleave", (event) => { lift(event); tip.hidden = true; });
  plan.addEventListener("click", (event) => {
    if (drag && drag.moved) return;
    const c = cellAt(inLevel(pointer(event)));
    draw("cursor", "");
    choose(c);
    state.cursor = c;
  });
  plan.addEventListener("wheel", (event) => {
    if (!event.ctrlKey && document.activeElement !== plan) return;
    event.preventDefault();
    zoom(event.deltaY > 0 ? 1.2 : 1 / 1.2, pointer(event));
  }, { passive: false });
  const step = (dx, dy) => {
    if (state.cursor < 0) state.cursor = state.source >= 0 ? state.source : 0;
    else {
      // The neighbour that lies most in that direction, or the nearest cell over there.
      const [x, y] = middle(state.cursor);
      let best = -1, least = Infinity;
      for (let c = 0; c < n; c++) {
        const [u, v] = middle(c), along = (u - x) * dx + (v - y) * dy, off = Math.abs((u - x) * dy) + Math.abs((v - y) * dx);
        if (along > 0 && along + 2.5 * off < least) { least = along + 2.5 * off; best = c; }
      }
      if (best >= 0) state.cursor = best;
    }
    draw("cursor", outline(state.cursor));
    reveal(state.cursor);
    const m = facts.measures.find((k) => k.key === $("measure").value) || facts.measures[0];
    if (state.source < 0) tell(nameOf(state.cursor), [figures(state.cursor), paragraph("Press Enter to see what is visible from here.")]);
    else $("told").append(paragraph(`At ${nameOf(state.cursor)}: ${m.title.toLowerCase()} ${withUnit(m, measures[m.key][state.cursor])}, ${sees(state.source, state.cursor) ? "visible" : "hidden"}.`));
    while ($("told").children.length > 4) $("told").children[2].remove();
  };
  plan.addEventListener("keydown", (event) => {
    const keys = {
      ArrowLeft: () => step(-1, 0), ArrowRight: () => step(1, 0), ArrowUp: () => step(0, 1), ArrowDown: () => step(0, -1),
      "+": () => zoom(1 / 1.4), "=": () => zoom(1 / 1.4), "-": () => zoom(1.4), 0: () => setView(whole),
      Escape: () => { draw("cursor", ""); clear(); },
      Enter: () => { if (state.cursor >= 0) (event.shiftKey && state.source >= 0 ? pickSecond : pick)(state.cursor); },
    };
    if (!keys[event.key] || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    keys[event.key]();
  });
  $("zoom-in").onclick = () => zoom(1 / 1.5);
  $("zoom-out").onclick = () => zoom(1.5);
  $("zoom-all").onclick = () => setView(whole);
  $("clear").onclick = clear;

  // ---- the heat map's measure
  $("measure").onchange = () => {
    const key = $("measure").value, change = key === "growth";
    const m = change ? { title: "Change of the visible area", unit: "", steps: facts.growth } : facts.measures.find((x) => x.key === key);
    const values = change ? growth : measures[key], last = m.steps.length - 1;
    // For changes four classes shrink and four grow: each of twice the width.
    const class_ = (x) => {
      if (!change) { const k = m.steps.findIndex((s) => x <= s * (1 + 1e-6)); return k < 0 ? last : k; }
      const k = Math.min(3, Math.max(0, Math.ceil(Math.abs(x) / (2 * m.steps[0])) - 1));
      return x < 0 ? 3 - k : 4 + k;
    };
    const paths = m.steps.map(() => []);
    for (let c = 0; c < n; c++) if (!Number.isNaN(values[c]) && !(change && values[c] === 0)) paths[class_(values[c])].push(outline(c));
    const letter = change ? "c" : "h";
    [...$("heat").children].forEach((path, k) => {
      path.setAttribute("class", `h ${letter}${k}`);
      path.setAttribute("d", paths[k].join(""));
    });
    const legend = $("legend");
    legend.replaceChildren();
    element("span", m.title + (m.unit ? ` (${m.unit})` : "") + ": ", legend);
    m.steps.forEach((s, k) => {
      const swatch = element("span", undefined, legend);
      swatch.className = "swatch";
      element("i", undefined, swatch).className = letter + k;
      swatch.append(change ? (k < 4 ? "≥ −" + number(2 * m.steps[0] * (4 - k)) : "≤ +" + number(2 * m.steps[0] * (k - 3))) : "≤ " + number(s));
    });
  };

  // ---- search, and links from the tables
  const show = () => $("plan-section").scrollIntoView({ behavior: matchMedia("(prefers-reduced-motion: reduce)").matches ? "auto" : "smooth" });
  const pickRoom = (k) => {
    const cells = [];
    for (let c = 0; c < n; c++) if (room[c] === k) cells.push(c);
    const seen = new Set(cells.flatMap(seenFrom));
    clear();
    stage.classList.add("chosen");
    state.seen = [...seen].sort((a, b) => a - b);
    draw("seen", state.seen.filter((c) => room[c] !== k).map(outline).join(""));
    draw("source", cells.map(outline).join(""));
    tell(facts.rooms[k], [paragraph(`${number(cells.length)} cells; from somewhere in it, ${number(seen.size)} cells are seen.`)]);
  };
  $("find").onsubmit = (event) => {
    event.preventDefault();
    const wanted = $("search").value.trim().toLowerCase(), cell = wanted.match(/^(?:cell\s*)?(\d+)$/);
    if (cell && Number(cell[1]) < n) { pick(Number(cell[1])); reveal(Number(cell[1])); return; }
    let k = facts.rooms.findIndex((r) => r.toLowerCase() === wanted);
    if (k < 0 && wanted) k = facts.rooms.findIndex((r) => r.toLowerCase().includes(wanted));
    if (k < 0) return tell("Nothing found", [paragraph(`There is no cell or room “${$("search").value}”.`)]);
    pickRoom(k);
  };
  const pickGap = (k) => {
    const gap = facts.gaps[k];
    clear();
    draw("gap", chain(gap.segment));
    for (const p of gap.segment) dot(p, 3, true);
    tell(gap.title, [paragraph(`Closing it would shrink the mean visible set by ${number(gap.share * 100)} %.`)]);
  };
  document.addEventListener("click", (event) => {
    const button = event.target.closest && event.target.closest("button.link");
    if (!button) return;
    const { cell, gap, lane, walk, room: k } = button.dataset;
    if (cell !== undefined) { pick(Number(cell)); reveal(Number(cell)); }
    if (gap !== undefined) pickGap(Number(gap));
    if (k !== undefined) pickRoom(Number(k));
    if (lane !== undefined) { clear(); draw("sight", chain(facts.lanes[lane])); facts.lanes[lane].forEach((p) => dot(p, 4)); tell("A lane", [paragraph(button.parentElement.textContent)]); }
    if (walk !== undefined) { clear(); draw("walk", chain(facts.walks[walk])); tell(button.textContent, [paragraph("The walk is dashed.")]); }
    show();
  });

  // ---- tables that can be sorted
  const sorted = (body, compare) => body.append(...[...body.rows].sort(compare));
  const key = (cell) => (cell.dataset.sort !== undefined ? Number(cell.dataset.sort) : Number(cell.textContent.replace(/,/g, "")));
  for (const table of document.querySelectorAll("table.sortable")) {
    [...table.tHead.rows[0].cells].forEach((head, k) => {
      const button = document.createElement("button");
      button.type = "button";
      button.className = "sort";
      button.append(...head.childNodes);
      head.append(button);
      let up = true;
      button.onclick = () => {
        up = !up;
        for (const other of table.tHead.querySelectorAll("th")) other.removeAttribute("aria-sort");
        head.setAttribute("aria-sort", up ? "ascending" : "descending");
        sorted(table.tBodies[0], (p, q) => {
          const [x, y] = [key(p.cells[k]), key(q.cells[k])];
          const order = Number.isNaN(x) || Number.isNaN(y) ? q.cells[k].textContent.localeCompare(p.cells[k].textContent) : x - y;
          return up ? order : -order;
        });
      };
    });
  }
  const matrix = $("matrix");
  for (const button of matrix.querySelectorAll("button.sort")) {
    button.onclick = () => {
      const by = Number(button.dataset.sortBy);
      const of = (row) => (by < 0 ? -Number(row.dataset.row) : Number([...row.cells].find((c) => c.dataset.col === String(by)).dataset.n));
      sorted(matrix.tBodies[0], (p, q) => of(q) - of(p));
    };
  }

  // For tests, and for whoever wants to know on the console.
  window.enfilade = { state, sees, seenFrom, witness, cellAt, middle, onPlan, pick, pickSecond, clear, way, frame };
  document.documentElement.dataset.ready = "yes";
})();
