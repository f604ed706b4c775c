// What the sentences of the first screens claim, judged by the rows of a result alone.

import assert from "node:assert/strict";

/** A column of rows of numbers, at a time between samples. */
function valueAt({ time }, rows, width, column, now) {
  const k = Math.max(time.findLastIndex((value) => value <= now), 0);
  const [from, to] = [rows[k * width + column], rows[(k + 1) * width + column]];
  return time[k] < now ? from + ((now - time[k]) / (time[k + 1] - time[k])) * (to - from) : from;
}

const apart = (one, other) => Math.hypot(...one.map((value, i) => value - other[i]));
const samplesFrom = ({ time }, now) => [...time.keys()].filter((k) => time[k] >= now);

/** Check what a sentence claims by the claims of its lab; a sentence that nobody knows is an error. */
export function judge(claims, told) {
  const known = claims.filter(([pattern]) => pattern.test(told.said));
  assert.ok(known.length === 1, `${known.length} claims of: ${told.said}`);
  const [[pattern, holds]] = known;
  return holds(told, ...pattern.exec(told.said).slice(1));
}

// One point: its distance is along the ray, and an estimate of it may be behind the camera.

const TENTH = 0.1 + 1e-9;
const distanceOf = (y1, y2, inverse) => (inverse > 1e-4 ? Math.hypot(y1, y2, 1) / inverse : Infinity);

function distancesAt(shown, now) {
  const at = (rows) => distanceOf(...[0, 1, 2].map((c) => valueAt(shown, rows, 3, c, now)));
  return [at(shown.runs[0].estimate), at(shown.truth)];
}

function offAt({ truth, runs: [{ estimate }] }, k) {
  const [found, right] = [estimate, truth].map((rows) => distanceOf(...rows.subarray(3 * k, 3 * k + 3)));
  return found / right - 1;
}

/** How far an estimate is from the point, over the point's distance, at a sample. */
function besideAt({ truth, runs: [{ estimate }] }, k) {
  const [found, right] = [estimate, truth].map((rows) => {
    const [y1, y2, inverse] = rows.subarray(3 * k, 3 * k + 3);
    return [y1 / inverse, y2 / inverse, 1 / inverse];
  });
  return apart(found, right) / Math.hypot(...right);
}

/** Image velocity of a point at a distance along a ray, and at another one. */
function velocitiesAt({ settings: { A, b, believed }, truth, runs: [{ estimate }], ...shown }, now) {
  const [y1, y2, inverse] = [0, 1, 2].map((c) => valueAt(shown, truth, 3, c, now));
  const guess = valueAt(shown, estimate, 3, 2, now);
  return [[inverse, { A, b }], [guess, believed ?? { A, b }]].map(([one, motion]) => {
    const place = [y1 / one, y2 / one, 1 / one];
    const [u, v, w] = motion.b.map((value, i) => value + motion.A[i].reduce((sum, a, j) => sum + a * place[j], 0));
    return [(u - y1 * w) * one, (v - y2 * w) * one];
  });
}

const written = (distance) => (distance > 999 ? "∞" : `${distance.toFixed(distance < 2 ? 2 : 1)} m`);
const bothWritten = ({ shown, now }, ...texts) => distancesAt(shown, now).every((one, k) => written(one) === texts[k]);
const staysNear = ({ shown }, now) => samplesFrom(shown, now).every((k) => besideAt(shown, k) <= TENTH);
/** True where what is measured is too near the focus of expansion. */
function isUnseen({ shown: { settings, measured, radius, ...shown }, now }) {
  const { b, threshold } = settings;
  const [y1, y2, inverse] = [0, 1, 2].map((c) => valueAt(shown, shown.truth, 3, c, now));
  const apart = [y1 - b[0] / b[2], y2 - b[1] / b[2]].filter((_, c) => measured.includes(c));
  // Between samples the circle is entered or left a little sooner or later.
  return Math.abs(b[2]) * Math.hypot(radius * inverse, ...apart) < threshold + 0.02;
}

export const OBSERVER = [
  [/^One image shows the direction/, ({ now, shown: { time } }) => now - time[0] <= 0.15 * (time.at(-1) - time[0])],
  [/^Too near the focus of expansion/, isUnseen],
  [
    /^Found within 10 %: the estimate is at (.*), the point at (.*)\.$/,
    (told, found, right) => staysNear(told, told.now) && bothWritten(told, found, right),
  ],
  [
    /^Found, (.*) away\. Now drag/,
    (told, found) => staysNear(told, told.now) && written(distancesAt(told.shown, told.now)[0]) === found,
  ],
  [
    /^It is near (.*), but noise shakes it by ([\d.]+) %: it never stays within 10 %\.$/,
    ({ shown, now, ...told }, right, part) => {
      const { length } = shown.time;
      const last = [...Array(length).keys()].slice(Math.floor(0.75 * length)).map((k) => offAt(shown, k));
      const most = Math.max(...last.map(Math.abs));
      const mean = last.reduce((sum, off) => sum + off, 0) / last.length;
      const turns = last.filter((off, k) => k && (off - mean) * (last[k - 1] - mean) < 0).length;
      const bothSides = turns > 5 && shown.settings.noise.size > 0;
      const shortly = samplesFrom(shown, shown.time[0] + 0.9 * (now - shown.time[0]));
      const said = Math.abs(Number(part) / 100 / most - 1) < 0.06;
      const leaves = shortly.some((k) => Math.abs(offAt(shown, k)) > 0.099);
      const near = written(distancesAt(shown, now)[1]) === right && Math.abs(mean) <= TENTH;
      return told.end === now && bothSides && said && leaves && near && most > 0.1;
    },
  ],
  [
    /^It is within 10 % since ([\d.]+) s only/,
    ({ shown, now }, since) => {
      const late = Number(since) > shown.time[0] + 0.89 * (now - shown.time[0]);
      return late && staysNear({ shown }, Number(since) + 0.006);
    },
  ],
  [
    /^Not found in \d+ s: the estimate is too (near|far), at (.*), the point at (.*)\.$/,
    (told, way, ...texts) => {
      const [found, right] = distancesAt(told.shown, told.now);
      return (way === "near" ? found < 0.9 * right : found > 1.1 * right) && bothWritten(told, ...texts);
    },
  ],
  [
    /^Not found in \d+ s: the estimate is beside the point, at (.*), the point at (.*)\.$/,
    (told, ...texts) => {
      const { shown: { time }, now } = told;
      return !staysNear(told, time[0] + 0.9 * (now - time[0])) && bothWritten(told, ...texts);
    },
  ],
  [
    /^The estimate expects another motion than is seen/,
    ({ shown, now }) => {
      const [seen, expected] = velocitiesAt(shown, now).map((v) => v.filter((_, c) => shown.measured.includes(c)));
      return Math.hypot(...seen.map((value, c) => value - expected[c])) > 0.1 * Math.hypot(...seen);
    },
  ],
  [/^The estimate is farther than the map can show\.$/, ({ shown, now }) => distancesAt(shown, now)[0] === Infinity],
  [
    /^It grows at another rate than the estimate expects/,
    ({ shown, now }) => {
      const [found, right] = distancesAt(shown, now);
      return shown.settings.outputs.includes("s") && shown.settings.b[2] < 0 && Math.abs(found / right - 1) > 0.1;
    },
  ],
  [
    /^By now it is seen nearly as expected: the estimate is at (.*), the point at (.*)\.$/,
    (told, ...texts) => {
      const [seen, expected] = velocitiesAt(told.shown, told.now);
      const apart = Math.hypot(...seen.map((value, c) => (told.shown.measured.includes(c) ? value - expected[c] : 0)));
      return !(apart > TENTH * Math.hypot(...seen)) && bothWritten(told, ...texts);
    },
  ],
  [
    /^The point has left the picture\. The estimate is at (.*), the point at (.*)\.$/,
    (told, ...texts) => {
      const image = [0, 1].map((c) => valueAt(told.shown, told.shown.truth, 3, c, told.now));
      return Math.max(...image.map(Math.abs)) > 3 && bothWritten(told, ...texts);
    },
  ],
  [
    /^The observer believes another motion: its distance is (.*) times the true one\.$/,
    ({ shown, now }, times) => {
      const [found, right] = distancesAt(shown, now);
      const { believed, b } = shown.settings;
      return (found / right).toFixed(2) === times && apart(believed.b, b) > 0;
    },
  ],
  [
    /^Diverged at .* s: the estimate grew beyond all bounds\.$/,
    ({ shown, now }) => Number.isNaN(valueAt(shown, shown.runs[0].estimate, 3, 2, now)),
  ],
];

// Many points: C x of the states that the lab offers.

function placesAt({ points, n, settings }, rows, k) {
  const vector = (i) => Array.from(rows.subarray(n * k + 3 * i, n * k + 3 * i + 3));
  const add = (one, other) => one.map((value, i) => value + other[i]);
  return Array.from({ length: points }, (_, p) => {
    if (settings.state === "independent") return vector(p);
    if (settings.state === "body") return p ? add(vector(0), vector(p)) : vector(0);
    return add(vector(0), vector(p + 1));
  });
}

/** How far each mark's estimate is off at a sample. */
function offsAt(shown, k) {
  const [right, found] = [shown.truth, shown.estimate].map((rows) => placesAt(shown, rows, k));
  return right.map((place, p) => apart(place, found[p]));
}

const mean = (values) => values.reduce((sum, value) => sum + value, 0) / values.length;
const sizeOf = ({ settings: { points } }) =>
  Math.max(...points.flatMap((one) => points.map((other) => apart(one, other))));

/** The mean error, between the samples of a time. */
function meanOff({ shown, now }) {
  const values = Float64Array.from(shown.time, (_, k) => mean(offsAt(shown, k)));
  return valueAt(shown, values, 1, 0, now);
}

const isWritten = (told, text) => {
  if (text === "over 999") return meanOff(told) > 999;
  return Math.abs(meanOff(told) - Number(text)) <= (meanOff(told) < 1 ? 0.00501 : 0.0501);
};
const onIt = ({ shown, now }) =>
  samplesFrom(shown, now).every((k) => Math.max(...offsAt(shown, k)) <= sizeOf(shown) / 30);

/** The marks that are not seen. */
function unseenMarks({ shown, now }) {
  const k = Math.max(shown.time.findLastIndex((value) => value <= now), 0);
  const { points, outputs } = shown;
  return Array.from({ length: points }, (_, p) => p).filter((p) => Number.isNaN(outputs[2 * (k * points + p)]));
}

const NAMES = ["nose", "left wing tip", "right wing tip"];
const hiddenIn = (told, text) => {
  const marks = unseenMarks(told);
  const apart = told.shown.settings.state === "independent";
  const named = (p) => (apart ? `mark ${p + 1}` : `the ${NAMES[p]} (mark ${p + 1})`);
  return marks.length > 0 && text.toLowerCase() === marks.map(named).join(" and ");
};
const stands = ({ shown: { settings: { input, camera_velocity } } }) =>
  input === 0 && camera_velocity.every((value) => value === 0);

export const POINTS = [
  [/^The estimate, in blue:/, ({ now, shown: { time } }) => now <= 0.2 * time.at(-1)],
  [/^No mark is seen: nothing pulls/, (told) => unseenMarks(told).length === told.shown.points],
  [
    /^Still (.*) m off\. The dashed copy makes the same pictures/,
    (told, off) => {
      const { body } = told.seen;
      const copy = body.copy(body.larger());
      const marks = told.seen.places.map((_, p) => p).filter((p) => !unseenMarks(told).includes(p));
      const same = marks.every((p) => {
        const [one, other] = [copy[p], told.seen.places[p]].map(([X, Y, Z]) => [X / Z, Y / Z]);
        return apart(one, other) < 1e-3;
      });
      return same && isWritten(told, off) && !onIt(told) && told.now === told.end;
    },
  ],
  [/^Found\. Now press a mark/, (told) => onIt(told) && told.now === told.end],
  [/^Found: the estimate lies on the body, (.*) m off\.$/, (told, off) => onIt(told) && isWritten(told, off)],
  [
    /^Not found in \d+ s: the estimate is (.*) m off\.$/,
    (told, off) => told.now === told.end && !onIt(told) && isWritten(told, off),
  ],
  [
    /^(.*) (?:is|are) hidden: no ray pulls there, but the marks that are seen carry the body\.$/,
    (told, marks) => hiddenIn(told, marks) && told.shown.settings.state !== "independent",
  ],
  [/^(.*) (?:is|are) hidden: no ray pulls there\.$/, hiddenIn],
  [
    /^The camera does not travel: .* nothing tells how far it is\.$/,
    (told) => stands(told) && told.seen.body.unseen.length > 0,
  ],
  [/^The camera travels, so the rays turn/, (told) => !stands(told)],
  [/^The rays turn and pull anew/, stands],
  [/^Diverged at .* s: the estimate grew beyond all bounds\.$/, ({ shown: { divergedAt }, now }) => divergedAt <= now],
];

// Structure and motion: distances are 1 / (d_s ybar3), speeds those of the camera against the car.

/** An unknown's column of an estimate, or of the truth. */
function unknownAt(shown, rows, name, k) {
  const { choice: { unknown, scaled }, width } = shown;
  const place = unknown.indexOf(name);
  const value = rows[width * k + 3 + place];
  return scaled[place] && name !== "d_s" ? value / rows[width * k + 3 + unknown.indexOf("d_s")] : value;
}

function ratioAt({ shown, worlds }, k) {
  const { choice: { unknown }, truth, width, runs: [{ estimate }] } = shown;
  if (unknown.includes("d_s")) {
    const inverse = (rows) => {
      const scale = unknownAt(shown, rows, "d_s", k);
      return scale > 0 ? scale * rows[width * k + 2] : NaN;
    };
    const [found, right] = [estimate, truth].map(inverse);
    return found > 0 ? right / found : NaN;
  }
  const known = Array.from(worlds.velocities([shown.time[k]]).rows);
  const partOf = (rows, name, given) => (unknown.includes(name) ? unknownAt(shown, rows, name, k) : given);
  const speedOf = (rows) => {
    const part = (c) => partOf(rows, `v_c${c + 1}`, known[3 + c]) - partOf(rows, `v_p${c + 1}`, known[6 + c]);
    return Math.hypot(part(0), part(1), part(2));
  };
  return speedOf(estimate) / speedOf(truth);
}

/** True where there is an estimate now, and all that come lie within the tolerance. */
function isTold(told) {
  const { shown, now } = told;
  const ratios = samplesFrom(shown, now - 1e-12).map((k) => ratioAt(told, k));
  const offs = ratios.filter((ratio) => !Number.isNaN(ratio)).map((ratio) => Math.abs(ratio - 1));
  return offs.length > 0 && Math.max(...offs) <= shown.tolerance + 1e-9 && !inGap(told, 1, 0) && !inGap(told, 2, 0);
}

/** True within a gap, or as near to one as gaps are drawn as one. */
function inGap({ shown: { runs: [{ gaps }] }, now }, why, near = 0.1) {
  const long = near ? 0 : 0.05;
  const own = gaps.filter(([begin, end, each]) => each === why && end - begin >= long);
  return own.some(([begin, end]) => begin - near <= now && now <= end + near);
}

/** Parts of the known velocity of the camera against the car. */
const knownSpeed = ({ shown, worlds, now }) => {
  const open = (name) => shown.settings.unknown.includes(name);
  const row = Array.from(worlds.velocities([now]).rows);
  const parts = [0, 1, 2].filter((c) => !open(`v_c${c + 1}`) && !open(`v_p${c + 1}`));
  return parts.map((c) => row[3 + c] - row[6 + c]);
};
const refused = ({ shown: { refusal } }) => Boolean(refusal);
const sizeKnown = ({ shown: { settings } }) => !settings.unknown.includes("d_s");
const metresASecond = (text) => Math.abs(Number(text.replace("−", "-")));
const isKnown = (told, text) => Math.abs(Math.hypot(...knownSpeed(told)) - metresASecond(text)) < 0.0501;
const mayDrive = ({ shown: { settings } }) => settings.unknown.includes("v_p1");
const isRatio = ({ shown, worlds, now, at }, text) =>
  Math.abs(ratioAt({ shown, worlds }, at.sample) - Number(text)) < 0.00501 && now >= shown.time[0];

export const STRUCTURE = [
  [/^All of it is known/, ({ shown: { settings } }) => settings.unknown.length === 0],
  [/^Cannot be told: who moves/, (told) => refused(told) && sizeKnown(told)],
  [/^Cannot be told: how large and far the car is/, (told) => refused(told) && !sizeKnown(told) && mayDrive(told)],
  [/^(Is it a small car|A whole family of worlds|The film cannot tell)/, (told) => refused(told) && !sizeKnown(told)],
  [/^No estimate now: the car is so far away/, (told) => inGap(told, 1) && sizeKnown(told)],
  [/^No estimate now: the known speed is zero/, (told) => inGap(told, 1) && Math.hypot(...knownSpeed(told)) < 0.0501],
  [/^No estimate now: (−?[\d.]+) m\/s/, (told, speed) => inGap(told, 1) && isKnown(told, speed)],
  [/^No estimate yet:/, (told) => inGap(told, 2)],
  [/^No estimate now\.$/, (told) => Number.isNaN(ratioAt(told, told.at.sample))],
  [/^Found: the car's own speed/, (told) => isTold(told) && sizeKnown(told) && mayDrive(told)],
  [/^Found: with the size known, the film tells the camera's speed/, (told) => isTold(told) && sizeKnown(told)],
  [
    /^Found: only the true world needs the (−?[\d.]+) m\/s that are read\.$/,
    (told, speed) => isTold(told) && metresASecond(speed) > 0 && isKnown(told, speed),
  ],
  [/^Found: the estimate is (.*) times the true distance\.$/, (told, ratio) => isTold(told) && isRatio(told, ratio)],
  [
    /^Not found in \d+ s: the estimate is (.*) times the true (?:distance|speed)\.$/,
    (told, ratio) => {
      const off = Math.abs(ratioAt(told, told.at.sample) - 1);
      return told.now === told.end && off > told.shown.tolerance && isRatio(told, ratio);
    },
  ],
  [
    /^Not found in \d+ s: the (?:distance|speed) is right, but not yet each part/,
    (told) => {
      const { shown: { tolerance, runs: [{ error }] }, at } = told;
      return Math.abs(ratioAt(told, at.sample) - 1) <= tolerance && error.at(-1) > tolerance;
    },
  ],
  [/^The size is known, so the film tells a speed/, (told) => sizeKnown(told) && !refused(told)],
  [/^Each world needs another speed\./, (told) => !sizeKnown(told) && Math.hypot(...knownSpeed(told)) > 0],
  [/^Diverged at .* s: the estimate grew beyond all bounds\.$/, (told) => Number.isNaN(ratioAt(told, told.at.sample))],
];

