// The metrics over time, as SVG, with a cursor at the time that is shown.

const FIRST_METRICS = ['slip', 'rotation_captured', 'tracer_distance', 'volume_error', 'texture_cracks', 'kept_fraction'];
const CHARTS = 4;
const ROUNDING = 1e-12;  // what it leaves of zero at most
const MARGIN = {left: 56, right: 26, top: 8, bottom: 20};

const metrics = knownMetrics();

/// Those of which there is something to see, by name: {unit, meaning, better, values: {method: [...]}}.
function knownMetrics() {
  const {columns, values} = run.metrics, known = new Map();
  const add = (name, description, of) => {
    const here = Object.fromEntries(run.methods.map(({name: m}) => [m, of(m)]));
    if (Object.values(here).some(series => new Set(series.filter(x => x !== null).map(x => Math.abs(x) < ROUNDING ? 0 : x)).size > 1)) known.set(name, {...description, values: here});
  };
  const column = (name, method) => values[name]?.[method] ?? [];
  for (const description of columns)
    if (!['frame', 'time'].includes(description.name)) add(description.name, description, m => column(description.name, m));
  add('volume_error', {unit: '%', meaning: 'abs(volume / isosurface_volume - 1)', better: 'lower'},
      m => column('volume', m).map((v, f) => 100 * Math.abs(v / column('isosurface_volume', m)[f] - 1)));
  return known;
}

/// 1, 2, 2.5 or 5 times a power of ten, of which the range holds `count` or a few less.
function roundStep(range, count) {
  const about = range / count || 1, power = 10 ** Math.floor(Math.log10(about));
  return [1, 2, 2.5, 5, 10].find(digit => digit * power > 0.999 * about) * power;
}

function roundMarks(low, high, count) {
  const step = roundStep(high - low, count), marks = [];
  for (let k = Math.floor(low / step + 1e-6); ; ++k) {
    marks.push(k * step);
    if (k * step >= high - 1e-6 * step) return marks;
  }
}

/// The range to show: without values that are alone far outside, which would press all others flat.
function shownRange(numbers) {
  const sorted = numbers.toSorted((a, b) => a - b), at = share => sorted[Math.round(share * (sorted.length - 1))];
  const room = 0.5 * (at(0.96) - at(0.04)), low = Math.max(at(0), at(0.04) - room), high = Math.min(at(1), at(0.96) + room);
  return [low > 0 && low < 0.5 * high ? 0 : low, high];
}

const shortNumber = x => x === 0 ? '0' : Math.abs(x) >= 1e5 || Math.abs(x) < 1e-4 ? x.toExponential(1) : `${+x.toPrecision(4)}`;
const shownNumber = x => x === null || x === undefined ? '–' : x !== 0 && Math.abs(x) < 1e-4 ? x.toExponential(1) : x.toPrecision(3);

function svgElement(name, attributes, text) {
  const element = document.createElementNS('http://www.w3.org/2000/svg', name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text !== undefined) element.textContent = text;
  return element;
}

function htmlElement(name, properties = {}, children = []) {
  const element = Object.assign(document.createElement(name), properties);
  element.append(...children);
  return element;
}

/// A chart of one of the metrics. seek(time) is called where somebody points into it.
class Chart {
  #svg = svgElement('svg', {role: 'img'});
  #cursor = svgElement('line', {class: 'cursor'});
  #numbers = htmlElement('div', {className: 'chart-head'});

  constructor(name, seek) {
    this.select = htmlElement('select', {title: 'Metric'}, [...metrics.keys()].map(key => new Option(key.replaceAll('_', ' ') + (metrics.get(key).unit === '%' ? ' [%]' : ''), key)));
    this.select.value = name;
    this.select.onchange = () => { this.draw(); this.follow(); };
    this.element = htmlElement('div', {className: 'chart'}, [this.#numbers, this.#svg]);
    this.#svg.onpointerdown = event => { this.#svg.setPointerCapture(event.pointerId); seek(this.#timeAt(event)); };
    this.#svg.onpointermove = event => { if (event.buttons) seek(this.#timeAt(event)); };
  }

  get #metric() { return metrics.get(this.select.value); }
  get #width() { return this.#svg.clientWidth - MARGIN.left - MARGIN.right; }
  get #height() { return this.#svg.clientHeight - MARGIN.top - MARGIN.bottom; }
  #x(time) {
    const [first, last] = [run.times[0], run.times.at(-1)];
    return MARGIN.left + this.#width * (last > first ? (time - first) / (last - first) : 0);
  }
  #timeAt(event) {
    const share = (event.clientX - this.#svg.getBoundingClientRect().left - MARGIN.left) / this.#width;
    return run.times[0] + share * (run.times.at(-1) - run.times[0]);
  }

  draw() {
    const {values, unit, meaning, better} = this.#metric, shown = run.methods.filter((_, m) => state.shown[m]);
    const numbers = shown.flatMap(({name}) => values[name]).filter(x => x !== null);
    const marks = roundMarks(...shownRange(numbers), 3), [low, high] = [marks[0], marks.at(-1)];
    const y = value => MARGIN.top + this.#height * (high - value) / (high - low || 1);
    this.select.title = `${meaning.replace(/\[([^\]]*)\]\([^)]*\)/g, '$1').replaceAll('`', '')}${unit === '1' ? '' : ` [${unit}]`}${better ? `; better: ${better}` : ''}`;
    this.#svg.setAttribute('aria-label', this.select.title);
    this.#svg.replaceChildren();
    for (const mark of marks) {
      this.#svg.append(svgElement('line', {class: 'grid', x1: MARGIN.left, x2: MARGIN.left + this.#width, y1: y(mark), y2: y(mark)}),
                       svgElement('text', {x: MARGIN.left - 6, y: y(mark) + 4, 'text-anchor': 'end'}, shortNumber(mark)));
    }
    this.#drawTimes();
    const curves = svgElement('svg', {x: MARGIN.left, y: MARGIN.top - 1, width: this.#width, height: this.#height + 2,
                                      viewBox: `${MARGIN.left} ${MARGIN.top - 1} ${this.#width} ${this.#height + 2}`});
    this.#svg.append(curves);
    run.methods.forEach(({name}, m) => { if (state.shown[m]) this.#drawCurve(curves, values[name], METHOD_COLOURS[m % METHOD_COLOURS.length], y); });
    this.#svg.append(this.#cursor);
  }

  #drawTimes() {
    const last = run.times.at(-1), bottom = MARGIN.top + this.#height + 15;
    for (const time of roundMarks(run.times[0], last, 5))
      if (time <= last) this.#svg.append(svgElement('text', {x: this.#x(time), y: bottom, 'text-anchor': 'middle'}, `${shortNumber(time)} s`));
  }

  /// With gaps where there is no value.
  #drawCurve(curves, series, stroke, y) {
    let points = [];
    const finish = () => {
      if (points.length > 0) curves.append(svgElement('polyline', {points: points.join(' '), stroke}));
      points = [];
    };
    series.forEach((value, f) => value === null ? finish() : points.push(`${this.#x(run.times[f]).toFixed(1)},${y(value).toFixed(1)}`));
    finish();
  }

  /// Puts the cursor and the numbers to the frame that is shown.
  follow() {
    const x = this.#x(run.times[state.frame]);
    for (const [key, value] of Object.entries({x1: x, x2: x, y1: MARGIN.top, y2: MARGIN.top + this.#height})) this.#cursor.setAttribute(key, value);
    const numbers = run.methods.flatMap(({name}, m) => !state.shown[m] ? [] : [htmlElement('span', {
      textContent: shownNumber(this.#metric.values[name][state.frame]), title: name, style: `color:${METHOD_COLOURS[m % METHOD_COLOURS.length]}`})]);
    this.#numbers.replaceChildren(this.select, ...numbers);
  }
}

/// The first metrics that the run has, one a chart.
function makeCharts(seek) {
  const wanted = [...FIRST_METRICS, ...metrics.keys()].filter(name => metrics.has(name));
  return [...new Set(wanted)].slice(0, CHARTS).map(name => new Chart(name, seek));
}
