"use strict";
// A gas of the event-driven engine: `gaspart.engines.event.dynamics` with the engine's own kernels. All numbers
// of physics are in an image of the kernels' memory, and in patches for the values of controls.
const STOP = 0, COLLAPSE = 3, MANY = 2 ** 18, QUIET = 64, EPOCH = 10, AT_REST = 2 ** 960, OTHER = 2 ** 10;
const sumOf = values => {  // in numpy's order, because a length may change where a sum is a power of two
  const n = values.length, part = new Float64Array(8);
  if (n > 128) {
    const half = (n >> 1) - (n >> 1) % 8;
    return sumOf(values.slice(0, half)) + sumOf(values.slice(half));
  }
  let total = 0, i = 0;
  if (n >= 8) {
    for (; i < n - n % 8; i++) part[i % 8] += values[i];
    total = ((part[0] + part[1]) + (part[2] + part[3])) + ((part[4] + part[5]) + (part[6] + part[7]));
  }
  for (; i < n; i++) total += values[i];
  return total;
};
const exponent = x => {  // e of x = m 2^e with m from 1/2 to 1
  let e = Math.floor(Math.log2(x)) + 1;
  while (x >= 2 ** e) e++;
  while (x < 2 ** (e - 1)) e--;
  return e;
};
const powerOfTwo = (time, more) => time < AT_REST ? Math.min(2 ** (exponent(time) + more), AT_REST) : AT_REST;

class Gas {
  // data: of the page; start: its number; values: index of the value of each control.
  static flags(data, values) {
    const letters = data.controls.map(control => control.flags[values[control.name]]);
    return [...new Set([...data.constant, ...letters.join("")])].sort().join("");
  }
  static async of(data, start, values) {  // raises an Error with a reason for scenes that are not in the page
    const flags = Gas.flags(data, values), has = letters => [...letters].every(letter => flags.includes(letter));
    for (const [both, unless, reason] of data.rules) if (has(both) && !(unless && has(unless))) throw Error(reason);
    const image = data.starts[start].images[flags.replace("t", "")];
    if (!image) throw Error("this combination is not in the page");
    data.compiled ??= {};
    data.compiled[image.module] ??= WebAssembly.compile(data.modules[image.module]);
    return new Gas(data, data.starts[start], image, await data.compiled[image.module], values, flags);
  }
  constructor(data, start, image, module, values, flags) {
    Object.assign(this, { data, image, flags, count: start.count, dimension: data.lengths.length });
    this.start = start; this.scene = image.scene;
    const { blob } = image, d = this.dimension;
    this.memory = new WebAssembly.Memory({ initial: Math.ceil((image.start + blob.length) / 65536) });
    const stack = new WebAssembly.Global({ value: "i32", mutable: true }, image.start);
    const env = { __linear_memory: this.memory, __stack_pointer: stack, fmod: (a, b) => a % b };
    this.kernels = new WebAssembly.Instance(module, { env }).exports;
    new Uint8Array(this.memory.buffer).set(blob, image.start);
    this.view = new DataView(this.memory.buffer);
    const doubles = (name, length) => new Float64Array(this.memory.buffer, image.arrays[name], length);
    this.flights = doubles("flights", 8 * this.count);  // position, velocity, clock, radius
    this.images = new BigInt64Array(this.memory.buffer, image.arrays.images, d * this.count);
    this.impulses = doubles("wall_impulse", 4 * d);
    this.sums = doubles("sums", 4);
    this.counts = new BigInt64Array(this.memory.buffer, image.arrays.counts, 6);
    this.hits = new BigInt64Array(this.memory.buffer, image.arrays.wall_hits, 2 * d);
    this.numbers = doubles("numbers", 5 + 2 * d);
    this.piston = image.arrays.piston && doubles("piston", 3);
    this.spins = image.arrays.spins && doubles("spins", 3 * this.count);
    this.#patch(values);
    this.factors = image.scaled.map(at => this.view.getFloat64(at, true));
  }
  #patch(values) {
    for (const [group, patches] of Object.entries(this.image.patches)) {
      let index = 0;
      for (const control of this.data.controls.filter(one => one.group === group))
        index = index * control.values.length + values[control.name];
      if (!patches[index]) throw Error("this combination is not in the page");
      const [words, changes] = patches[index], from = new DataView(words.buffer);
      const present = mapping => Object.fromEntries(Object.entries(mapping).filter(([, value]) => value !== null));
      this.scene = present({ ...this.scene, ...changes, faces: present({ ...this.scene.faces, ...changes.faces }) });
      for (let at = 0; at < words.length; at += 12)
        this.view.setBigInt64(from.getUint32(at, true), from.getBigInt64(at + 4, true), true);
    }
  }
  #call(kernel) {
    if (this.kernels[kernel](this.image.words[kernel], this.image.arrays.out, this.image.arrays.out + 64))
      throw Error(`the kernel ${kernel} failed`);
  }
  #set(slot, value) { for (const at of this.image.slots[slot]) this.view.setFloat64(at, value, true); }
  get time() { return this.epochStart + this.clock; }
  get collisions() { return Number(this.counts[0]); }
  get impulse() {  // momentum given to each face since the beginning
    return Array.from({ length: 2 * this.dimension }, (_, n) => (this.impulses[2 * n] + this.impulses[2 * n + 1]) * this.image.unit);
  }

  // Begin from a state at time 0, as a Simulation that is given it as its initial state.
  begin({ positions, velocities, spins, piston }) {
    const { data, count, dimension: d } = this, boxes = this.image.boxes;
    this.#beginPiston(piston);
    const place = this.pistonAt(0), face = data.pistonFace;
    for (let i = 0; i < count; i++) for (let k = 0; k < d; k++) {
      let x = positions[d * i + k];
      if (!data.periodic[k]) {
        const inset = data.margin * this.flights[8 * i + 2 * d + 1];
        let low = inset, high = data.lengths[k] - inset;
        if (place !== null && face >> 1 === k) { if (face % 2) high = place - inset; else low = place + inset; }
        x = Math.min(Math.max(x, low), high);
      }
      this.flights[8 * i + k] = x; this.flights[8 * i + d + k] = velocities[d * i + k];
      const box = Math.min(Math.max(Math.trunc(x / boxes[k][1]), 0), boxes[k][0] - 1);
      this.view.setInt32(this.image.arrays.predictions + 64 * i + 40 + 4 * k, box, true);
    }
    if (this.spins) for (let i = 0; i < count; i++) this.spins[3 * i + 2] = this.numbers.at(-2) ? spins[i] : 0;
    this.quiet = this.epochStart = this.clock = 0;
    this.base = this.#nextBase(0);
    this.#beginEpoch(this.base);
    this.#predict();
  }
  #beginPiston(state) {
    if (!this.piston || !state) return;
    const face = this.data.pistonFace, upper = face % 2, length = this.data.lengths[face >> 1];
    this.piston[0] = upper ? length - state[0] : state[0];
    if (!this.numbers.at(-1)) this.piston[1] = upper ? -state[1] : state[1];
  }
  pistonAt(time) {  // the piston's coordinate at a time of the clocks, after its latest hit
    if (!this.piston) return null;
    const kept = this.piston.slice();
    this.#set("time", time); this.#call("piston");
    const [height, velocity] = this.piston, face = this.data.pistonFace, length = this.data.lengths[face >> 1];
    this.piston.set(kept);
    this.pistonVelocity = face % 2 ? -velocity : velocity;
    return face % 2 ? length - height : height;
  }
  // The present state.
  get state() {
    const { data, count, dimension: d } = this, kept = this.flights.slice();
    this.#set("time", this.clock); this.#call("advance");
    const positions = new Float64Array(d * count), velocities = new Float64Array(d * count), images = this.images.slice();
    for (let i = 0; i < count; i++) for (let k = 0; k < d; k++) {
      const n = d * i + k, length = data.lengths[k], there = this.flights[8 * i + k];
      positions[n] = there; velocities[n] = this.flights[8 * i + d + k];
      if (!data.periodic[k] || (there >= 0 && there < length)) continue;
      const crossed = there < 0 ? -1 : 1, moved = there - crossed * length;  // beyond a face because of rounding
      positions[n] = moved >= length ? 0 : moved; images[n] += BigInt(crossed);
    }
    this.flights.set(kept);
    const place = this.pistonAt(this.clock), piston = place === null ? null : [place, this.pistonVelocity];
    return { positions, velocities, images, spins: this.#spins(), piston };
  }
  #spins() { return Float64Array.from({ length: this.count }, (_, i) => this.spins ? this.spins[3 * i + 2] : 0); }

  // Advance to a time, by at most a number of events; returns the number of events.
  advance(until, most = Infinity) {
    let left = most;
    while (left > 0) {
      const stop = until - this.epochStart, endsEpoch = stop > this.epoch, [at] = this.image.slots.limits;
      this.view.setFloat64(at, Math.min(stop, this.epoch), true);
      this.view.setBigInt64(at + 8, BigInt(Math.min(left, MANY)), true);
      this.view.setBigInt64(at + 16, BigInt(MANY), true);
      this.#call("run");
      const { out } = this.image.arrays, [reason, done] = [0, 8].map(n => Number(this.view.getBigInt64(out + n, true)));
      left -= done;
      if (done) this.quiet = 0;
      if (reason === STOP && !endsEpoch) { this.clock = stop; break; }
      if (reason === STOP) this.#nextEpoch();
      else this.clock = Math.max(this.clock, this.view.getFloat64(out + 24, true));
      if (reason === COLLAPSE) throw Error("an inelastic collapse: infinitely many collisions in a finite time");
    }
    return most - left;
  }
  #nextEpoch() {
    this.#set("time", this.epoch); this.#call("restart");
    this.epochStart += this.epoch; this.clock = 0;
    if (this.piston) { this.#set("time", this.epoch); this.#call("piston"); this.piston[2] = 0; }
    for (const [at, length] of this.image.times) {
      const times = new Float64Array(this.memory.buffer, at, length);
      for (let n = 0; n < length; n++) times[n] -= this.epoch;
    }
    this.quiet++;
    this.base = this.#nextBase(this.base);
    const speed = this.#speed(), most = speed > 0 ? powerOfTwo(Math.max(...this.data.lengths) / speed, 0) : this.base;
    const doublings = Math.min(Math.max(this.quiet - QUIET, 0), Math.max(0, exponent(most) - exponent(this.base)));
    this.#beginEpoch(this.base * 2 ** doublings);
    this.#predict();
  }
  #predict() { this.#set("now", this.clock); this.#call("begin"); }
  #beginEpoch(length) {
    this.epoch = length;
    this.image.scaled.forEach((at, n) => this.view.setFloat64(at, this.factors[n] * length, true));
  }
  // Length of an epoch: `gaspart.engines.event.tally.Epochs`.
  #squares() {
    const { count, dimension: d } = this, squares = new Float64Array(count);
    for (let i = 0; i < count; i++) for (let k = 0; k < d; k++) squares[i] += this.flights[8 * i + d + k] ** 2;
    return squares;
  }
  #speed() {
    const [pull, piston, walls, ...faces] = this.numbers.slice(0, -2);
    return Math.sqrt(sumOf(this.#squares()) / this.count + (pull + Math.max(walls, ...faces) + piston));
  }
  #nextBase(present) {
    const { masses, inertia } = this.start, kept = (length, before) => before / OTHER < length && length < before * OTHER ? before : length;
    const of = speed => speed > 0 ? powerOfTwo(this.start.diameter / speed, EPOCH) : AT_REST;
    const squares = this.#squares(), moving = masses.filter(Number.isFinite), { length: number } = moving;
    const turning = this.spins ? inertia.map((value, i) => this.spins[3 * i + 2] ? this.spins[3 * i + 2] ** 2 * value : 0) : [];
    const energy = 0.5 * sumOf(squares.map((square, i) => masses[i] * square).filter((_, i) => Number.isFinite(masses[i]))) + 0.5 * sumOf(turning);
    const length = kept(of(this.#speed()), present), inverse = sumOf(moving.map(mass => 1 / mass)) / number;
    return Math.min(length, kept(of(number ? Math.sqrt(2 * energy / number * inverse) : 0), length));
  }
}
// The data of a page: JSON, and bytes after it.
function dataOf(raw) {
  const end = raw.indexOf(0), stored = raw.subarray(end + 1);
  const data = JSON.parse(new TextDecoder().decode(raw.subarray(0, end)), (_, value) => value?.bytes ? stored.slice(...value.bytes) : value);
  for (const start of data.starts)
    for (const name of ["positions", "velocities", "spins", "radii", "masses", "inertia", "weights"]) start[name] = new Float64Array(start[name].buffer);
  return data;
}
const startOf = (data, start) => ({ ...data.starts[start], piston: null });
if (typeof module !== "undefined") module.exports = { Gas, dataOf, startOf };
