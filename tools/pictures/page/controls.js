// Buttons, keys and pointers, and the passing of time.

const byId = id => document.getElementById(id);
const charts = makeCharts(time => seek(frameAt(time)));
const COLOUR_NAMES = {material_slip: 'Slip', mean_curvature: 'Curvature', confidence: 'Confidence', emission_time: 'Time of inflow'};
const SLOW = 45, FAST = 22;   // between two drawings while things move [ms]
const LEAST_SHARPNESS = 0.5;
const REST = 250;             // after which all is sharp again [ms]

let scheduled = false, changed = true, moving = false, lastTick = 0, lastDrew = false, restTimer = 0;

/// Something has changed that is seen.
function schedule() {
  changed = true;
  requestTick();
}

function requestTick() {
  if (scheduled) return;
  scheduled = true;
  requestAnimationFrame(tick);
}

/// Draws where something has changed, and goes on for as long as something moves by itself.
function tick(now) {
  scheduled = false;
  const passed = Math.min(now - lastTick, 250);
  lastTick = now;
  if (state.playing) advance(passed / 1000);
  if ((state.playing || moving) && lastDrew) adaptSharpness(passed);
  lastDrew = changed;
  if (changed) draw();
  changed = false;
  if (state.playing) requestTick();
}

/// Fewer pixels while drawing is too slow for the eye; all of them when nothing has moved for a moment.
function adaptSharpness(passed) {
  if (passed > SLOW) sharpness = Math.max(LEAST_SHARPNESS, sharpness - 0.125);
  else if (passed < FAST) sharpness = Math.min(1, sharpness + 0.0625);
  clearTimeout(restTimer);
  restTimer = setTimeout(() => { if (!state.playing && sharpness < 1) { sharpness = 1; schedule(); } }, REST);
}

/// The last frame that is not after that time.
function frameAt(time) {
  const frame = run.times.findLastIndex(t => t <= time + 1e-9);
  return Math.min(Math.max(frame, 0), surfaces.length - 1);
}

function advance(seconds) {
  state.time += seconds * state.speed;
  if (state.time >= run.times.at(-1) + 0.5 * state.speed) state.time = run.times[0];  // after a rest at the end
  const frame = frameAt(state.time);
  if (frame === surfaces.length - 1 && frame < run.times.length - 1) state.time = Math.min(state.time, run.times[frame]);
  if (frame !== state.frame) showFrame(frame);
}

function showFrame(frame) {
  state.frame = frame;
  changed = true;
  byId('slider').value = frame;
  byId('time').textContent = `t = ${run.times[frame].toFixed(2)} s,  frame ${frame} of ${run.times.length - 1}`;
  for (const chart of charts) chart.follow();
}

function seek(frame) {
  frame = Math.min(Math.max(frame, 0), surfaces.length - 1);
  state.time = run.times[frame];
  showFrame(frame);
  schedule();
}

function play(playing) {
  if (playing && state.frame === run.times.length - 1) state.time = run.times[0];
  state.playing = playing;
  lastTick = performance.now();
  byId('play').textContent = playing ? '❚❚' : '▶';
  byId('play').setAttribute('aria-label', playing ? 'Pause' : 'Play');
  sharpness = 1;
  schedule();
}

function setColour(colour) {
  state.colour = colour;
  [...byId('colours').children].forEach((button, i) => { button.setAttribute('aria-pressed', i === colour); });
  const shown = run.colours[colour - TEXTURES.length];
  byId('legend').hidden = !shown;
  if (shown) showLegend(shown);
  schedule();
}

function showLegend({title, range, labels, table}) {
  const bytes = bytesOf(table), bar = htmlElement('canvas', {width: 256, height: 1}), context = bar.getContext('2d');
  gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, 256, 1, gl.RGB, gl.UNSIGNED_BYTE, bytes);
  for (let k = 0; k < 256; ++k) {
    context.fillStyle = `rgb(${bytes.subarray(3 * k, 3 * k + 3).join()})`;
    context.fillRect(k, 0, 1, 1);
  }
  const numbers = Array.from({length: labels}, (_, k) => {
    const share = k / (labels - 1);
    return htmlElement('span', {textContent: shortNumber(range[0] + share * (range[1] - range[0])), style: `left:${100 * share}%`});
  });
  byId('legend-title').textContent = title;
  byId('legend-bar').replaceChildren(bar, ...numbers);
}

/// At least one method is shown.
function showMethod(m, shown) {
  state.shown[m] = shown;
  if (!state.shown.includes(true)) state.shown[m] = true;
  layOut();
}

function layOut() {
  [...byId('methods').querySelectorAll('input')].forEach((box, m) => { box.checked = state.shown[m]; });
  byId('names').replaceChildren(...panels().map(([m, left, top]) =>
    htmlElement('span', {style: `left:${left}px;top:${top}px`, title: run.methods[m].summary ?? ''}, [swatch(m), run.methods[m].name])));
  for (const chart of charts) { chart.draw(); chart.follow(); }
  schedule();
}

const swatch = m => htmlElement('i', {className: 'swatch', style: `background:${METHOD_COLOURS[m % METHOD_COLOURS.length]}`});

function turn(right, up) {
  camera.azimuth -= right;
  camera.elevation = Math.min(Math.max(camera.elevation + up, -1.55), 1.55);
  schedule();
}

/// By pixels of the page.
function move(right, down) {
  const [, , , w, h] = panels()[0], {axes, distance} = viewer(w / h), metres = 2 * distance * Math.tan(VIEW_ANGLE / 2) / h;
  camera.pan = plus(camera.pan, plus(times(-right * metres, axes[0]), times(down * metres, axes[1])));
  schedule();
}

function zoom(factor) {
  camera.zoom = Math.min(Math.max(camera.zoom * factor, 0.05), 20);
  schedule();
}

/// One pointer turns, with Shift or another button it moves; two move and zoom.
function handlePointers() {
  const pointers = new Map();
  canvas.onpointerdown = event => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, event);
    moving = true;
  };
  canvas.onpointermove = event => {
    const last = pointers.get(event.pointerId);
    if (!last) return;
    const right = event.clientX - last.clientX, down = event.clientY - last.clientY;
    pointers.set(event.pointerId, event);
    if (pointers.size === 2) {
      const [other] = [...pointers.values()].filter(p => p.pointerId !== event.pointerId);
      const apart = p => Math.hypot(p.clientX - other.clientX, p.clientY - other.clientY) || 1;
      zoom(apart(last) / apart(event));
      move(right / 2, down / 2);
    } else if (event.shiftKey || event.buttons & 6) move(right, down);
    else turn(0.008 * right, 0.008 * down);
  };
  canvas.onpointerup = canvas.onpointercancel = event => { pointers.delete(event.pointerId); moving = pointers.size > 0; };
  canvas.oncontextmenu = event => event.preventDefault();
  canvas.onwheel = event => { event.preventDefault(); zoom(Math.exp(0.0012 * event.deltaY * (event.deltaMode === 1 ? 30 : 1))); };
}

function handleKeys() {
  const turns = {ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1]};
  const keys = {
    ' ': () => play(!state.playing), ArrowLeft: () => seek(state.frame - 1), ArrowRight: () => seek(state.frame + 1),
    Home: () => seek(0), End: () => seek(run.times.length - 1),
    '+': () => zoom(0.85), '=': () => zoom(0.85), '-': () => zoom(1 / 0.85), 0: () => resetView(),
  };
  [...byId('colours').children].forEach((_, i) => { keys[i + 1] = () => setColour(i); });
  document.onkeydown = event => {
    const own = ['INPUT', 'SELECT', 'BUTTON'].includes(event.target.tagName);  // it has keys of its own
    if (event.ctrlKey || event.altKey || event.metaKey || (own && /^( |Arrow.*|Home|End)$/.test(event.key))) return;
    const turned = event.shiftKey && turns[event.key], action = turned ? () => turn(...turned) : keys[event.key];
    if (!action) return;
    event.preventDefault();
    action();
  };
}

function resetView() {
  resetCamera();
  schedule();
}

function makeControls() {
  byId('colours').append(...[...TEXTURES, ...run.colours.map(c => COLOUR_NAMES[c.array])].map((textContent, i) =>
    htmlElement('button', {textContent, title: `Key ${i + 1}`, onclick: () => setColour(i)})));
  byId('methods').append(...run.methods.map(({name, summary}, m) => htmlElement('label', {title: summary ?? ''}, [
    htmlElement('input', {type: 'checkbox', checked: true, onchange: event => showMethod(m, event.target.checked)}), ' ', swatch(m), name])));
  byId('charts').append(...charts.map(chart => chart.element));
  byId('slider').max = run.times.length - 1;
  byId('slider').oninput = event => { seek(+event.target.value); };
  byId('play').onclick = () => play(!state.playing);
  byId('speed').onchange = event => { state.speed = +event.target.value; };
  byId('reset').onclick = resetView;
  for (const option of ['walls', 'follow']) byId(option).onchange = event => { state[option] = event.target.checked; schedule(); };
  if (!run.walls) byId('walls').parentElement.hidden = true;
  handlePointers();
  handleKeys();
  new ResizeObserver(() => { draw(); requestAnimationFrame(layOut); }).observe(canvas);
}

function showOrigin() {
  const o = run.origin;
  byId('origin').textContent = `${o.source} (${o.hash}), run ${o.started} by kappaflow ${o.run_version}: ${o.command}. ` +
    `Page made ${o.made} by kappaflow ${o.page_version}; positions have 16 bits, normals and values 8.`;
}

async function start() {
  showOrigin();
  if (!gl) throw new Error('this browser has no WebGL 2');
  startDrawing();
  makeControls();
  const inflow = run.colours.findIndex(({array}) => array === 'emission_time');
  setColour(inflow < 0 ? 0 : TEXTURES.length + inflow);
  const message = byId('message');
  message.textContent = 'Unpacking…';
  if (run.walls) await loadWalls();
  await loadSurfaces(frame => {
    if (frame === 0) { seek(0); layOut(); }
    message.textContent = frame === 0 || frame === run.times.length - 1 ? '' : message.textContent;
  });
  document.body.dataset.loaded = run.times.length;
}

start().catch(error => {
  byId('message').textContent = `The page cannot be shown: ${error.message}`;
  throw error;
});
