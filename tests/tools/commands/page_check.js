// Put at the end of a page: uses it as a person would, looks at what it shows, and writes what is wrong into the body's
// attribute data-failures. An element that is still open keeps the browser from being done before.
const stillOpen = document.body.appendChild(Object.assign(document.createElement('iframe'), {hidden: true}));
stillOpen.contentDocument.open();

const failures = [];
const expect = (fine, what) => { if (!fine) failures.push(what); };
const wait = milliseconds => new Promise(done => setTimeout(done, milliseconds));
canvas.setPointerCapture = () => {};  // made-up pointers cannot be held
SVGElement.prototype.setPointerCapture = () => {};

async function until(condition, seconds) {
  for (const begin = performance.now(); performance.now() - begin < 1000 * seconds; await wait(20)) if (condition()) return true;
  return false;
}

const WIDTH = 480, HEIGHT = 200;
const copy = Object.assign(document.createElement('canvas'), {width: WIDTH, height: HEIGHT}).getContext('2d', {willReadFrequently: true});

/// What the page draws after an action, in small. What it does not draw anew is blank by then.
function shownAfter(action) {
  sharpness = 1;
  return new Promise(done => {
    action();
    requestAnimationFrame(() => {
      copy.clearRect(0, 0, WIDTH, HEIGHT);
      copy.drawImage(canvas, 0, 0, WIDTH, HEIGHT);
      done(copy.getImageData(0, 0, WIDTH, HEIGHT).data);
    });
  });
}

/// The share of a panel's pixels that `differs` says so of, given the place of their red.
function share(panel, panels, differs) {
  const begin = Math.ceil(WIDTH * panel / panels), end = Math.floor(WIDTH * (panel + 1) / panels) - 2;
  let count = 0;
  for (let y = 0; y < HEIGHT; ++y) for (let x = begin; x < end; ++x) count += differs(4 * (WIDTH * y + x));
  return count / (HEIGHT * (end - begin));
}
const changedShare = (a, b, panel, panels) =>
  share(panel, panels, i => Math.abs(a[i] - b[i]) + Math.abs(a[i + 1] - b[i + 1]) + Math.abs(a[i + 2] - b[i + 2]) > 30);
const PANELS = run.methods.length;
const anyChanged = (a, b) => run.methods.some((_, m) => changedShare(a, b, m, PANELS) > 0.01);
const allChanged = (a, b) => run.methods.every((_, m) => changedShare(a, b, m, PANELS) > 0.01);

function checkNotBlank(picture) {
  run.methods.forEach(({name}, m) => {
    const blue = share(m, PANELS, i => picture[i + 2] > picture[i] + 25), cream = share(m, PANELS, i => picture[i] > picture[i + 2] + 15);
    expect(blue > 0.02 && cream > 0.02, `blank: ${name}`);
  });
}

/// Against what the program measured on the surfaces that the page has in whole numbers.
function checkSurfaces() {
  const steps = minus(run.box.upper, run.box.lower).map(x => x / 65535), words = VERTEX_BYTES / 2;
  surfaces.forEach((frame, f) => frame.forEach((surface, m) => {
    const places = new Uint16Array(surface.buffer), point = v => steps.map((s, a) => s * places[words * v + a]);
    let area = 0, volume = 0;
    for (let t = 0; t < surface.corners.length; t += 3) {
      const [a, b, c] = [0, 1, 2].map(k => point(surface.corners[t + k])), normal = cross(minus(b, a), minus(c, a));
      area += Math.hypot(...normal) / 2;
      volume += dot(a, normal) / 6;
    }
    const measured = name => run.metrics.values[name][run.methods[m].name][f], near = (x, y) => Math.abs(x / y - 1) < 1e-3;
    expect(surface.vertices === measured('vertices') && surface.triangles === measured('triangles') &&
           near(area, measured('area')) && near(volume, measured('volume')), `surface ${f} of ${run.methods[m].name}`);
  }));
}

const cursorPlace = () => +document.querySelector('.chart .cursor').getAttribute('x1');

async function checkPlaying() {
  const first = await shownAfter(() => seek(0)), cursor = cursorPlace();
  byId('speed').value = '0.5';
  byId('speed').dispatchEvent(new Event('change'));
  byId('play').click();
  expect(await until(() => state.frame >= 3, 15), 'playing does not advance');
  byId('play').click();
  const frame = state.frame;
  await wait(300);
  expect(state.frame === frame, 'pausing does not stop');
  expect(+byId('slider').value === frame && cursorPlace() > cursor + 5, 'the slider and the cursor do not follow');
  expect(allChanged(first, await shownAfter(() => seek(frame))), 'playing changes no pixels');
}

async function checkColours() {
  const pictures = [];
  for (const button of [...byId('colours').children]) {
    pictures.push(await shownAfter(() => button.click()));
    expect(byId('legend').hidden === (pictures.length <= TEXTURES.length), `legend of ${button.textContent}`);
  }
  expect(pictures.length === 6, 'colours are missing');
  pictures.forEach((a, i) => pictures.slice(i + 1).forEach(b => expect(anyChanged(a, b), 'switching changes no pixels')));
  byId('colours').children[0].click();
}

async function checkCamera() {
  const pointer = (type, x, buttons) => canvas.dispatchEvent(new PointerEvent(type, {pointerId: 1, clientX: x, clientY: 300, buttons}));
  const before = await shownAfter(() => byId('reset').click());
  const turned = await shownAfter(() => { pointer('pointerdown', 300, 1); pointer('pointermove', 360, 1); pointer('pointerup', 360, 0); });
  expect(allChanged(before, turned), 'cameras are not linked');
  const nearer = await shownAfter(() => canvas.dispatchEvent(new WheelEvent('wheel', {deltaY: -300})));
  expect(allChanged(turned, nearer), 'the wheel does not zoom');
  const key = (name, shiftKey) => document.body.dispatchEvent(new KeyboardEvent('keydown', {key: name, shiftKey, bubbles: true}));
  expect(allChanged(nearer, await shownAfter(() => key('ArrowUp', true))), 'keys do not turn');
  expect(!anyChanged(before, await shownAfter(() => key('0', false))), 'the first view does not come back');
}

async function checkMethodsAndTime() {
  const all = await shownAfter(() => seek(2)), box = byId('methods').querySelector('input');
  const fewer = await shownAfter(() => box.click());
  expect(changedShare(all, fewer, 0, 1) > 0.05 && byId('names').children.length === PANELS - 1, 'a method cannot be hidden');
  expect(!anyChanged(all, await shownAfter(() => box.click())), 'a method does not come back');
  const chart = document.querySelector('.chart svg'), {right, top} = chart.getBoundingClientRect();
  const last = await shownAfter(() => chart.dispatchEvent(new PointerEvent('pointerdown', {pointerId: 1, clientX: right, clientY: top + 20, buttons: 1})));
  expect(state.frame === run.times.length - 1 && allChanged(all, last), 'pointing into a curve does not go to its time');
}

async function check() {
  if (!await until(() => +document.body.dataset.loaded === run.times.length, 60)) throw new Error(`not loaded: ${byId('message').textContent}`);
  await wait(200);
  checkNotBlank(await shownAfter(() => seek(0)));
  checkSurfaces();
  await checkPlaying();
  await checkColours();
  await checkCamera();
  await checkMethodsAndTime();
}

check().catch(error => failures.push(error.message)).then(async () => {
  failures.push(...problems);
  document.body.dataset.failures = JSON.stringify([...new Set(failures)]);
  seek(2);
  await wait(300);
  stillOpen.contentDocument.close();
});
