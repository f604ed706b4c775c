// What passes from computing to drawing: results, which are plain data without functions, nodes of the page, or arrays
// that a later run writes to, so that they may be kept, drawn again, or come from a worker; then schemas and charts.
// Rows of numbers lie one after the other in a Float64Array, a row a sample; NaN stands for what is not there.

/**
 * @typedef {Record<string, any>} Settings  all that defines what is shown; their schema says what each may be
 *
 * @typedef {object} ObserverRun  what one observer made of a recording
 * @property {string} name
 * @property {string} title        its name for people
 * @property {number} order        its place among all observers, which gives its line a colour and dashes
 * @property {Float64Array} estimate  rows of `width` coordinates
 * @property {Float64Array | null} deviation  the standard deviations that it claims, in the same rows
 * @property {Float64Array} resets  times, in s
 * @property {[begin: number, end: number, reason: number][]} gaps  when hidden coordinates have no estimate
 * @property {string[]} gapReasons  for the numbers of gaps, from 1 on
 * @property {number | null} divergedAt  in s
 * @property {Float64Array | null} error  the relative error of what is judged at each sample
 * @property {number | null} settling  seconds from the first sample until the error stays in the tolerance, or Infinity
 *
 * @typedef {object} SharedResult  what the labs of single points show
 * @property {Settings} settings   those that it is the result of, the very object
 * @property {string} [problem]    why there is nothing to show
 * @property {string} [refusal]    why what is sought cannot be estimated, or nothing
 * @property {boolean} whole       whether all that is read off it is there, or only what its pictures need
 * @property {Float64Array} time   of the samples, in s
 * @property {Float64Array} outputs  rows of `sampled` measured coordinates; NaN where a sample was lost
 * @property {number} sampled
 * @property {Float64Array | null} truth  rows of `width` coordinates
 * @property {number} width
 * @property {string[]} names      of the coordinates
 * @property {number[]} measured   which of them are measured
 * @property {number[]} hidden     which of them are not
 * @property {string[]} hiddenNames
 * @property {number | null} leavesAt  when the point leaves the half-space in front of the camera, in s
 * @property {number} tolerance    of the relative error
 * @property {number} settledPart  of the run in which the error must have been in it
 * @property {string} [judged]     what it is an error of, in words
 * @property {ObserverRun[]} runs
 *
 * @typedef {object} Excitation
 * @property {number} window       in s
 * @property {Float64Array} time   at which windows end, in s
 * @property {Float64Array} smallest  eigenvalue of the integral of w w^T over the window
 * @property {{time: Float64Array, smallest: Float64Array}} begun  the same since the first sample, until a window is
 *   full
 *
 * @typedef {object} OfObserverLab
 * @property {number[] | null} foe  the focus of expansion in the image; null where it is at infinity
 * @property {number[] | null} foeTowards  the direction in which it is there, of length 1
 * @property {number[] | null} circle  its y1, y2 and radius, within which |w| is below the threshold
 * @property {number[][]} inside  when the image of the point is in it: begin and end
 * @property {Excitation | null} excitation
 * @property {Float64Array | null} bound  the least relative error that the noise leaves, at each sample
 * @typedef {SharedResult & OfObserverLab} ObserverResult
 *
 * @typedef {object} OfStructureLab
 * @property {Float64Array} image  rows of the true y1, y2 and ybar3
 * @property {number} scale        the true d_s, in 1/m
 * @property {number} [speed]      the point's greatest against the camera, in m/s
 * @property {{unknown: string[], scaled: boolean[], square: boolean} | null} choice  of unknowns, if it is possible
 * @property {{sizes: Float64Array, determinants: Float64Array} | null} guard  how much errors are amplified
 * @property {{name: string, time: number, rate: number, step: number, shorter: number, remedy: string}[]} limits
 * @typedef {SharedResult & OfStructureLab} StructureResult
 *
 * @typedef {object} Gramian       what the images of each window tell of the state
 * @property {number} window       in s
 * @property {Float64Array} time   at which windows begin, in s
 * @property {Float64Array} smallest  eigenvalue
 * @property {Float64Array} largest  eigenvalue
 * @property {number} weakest      the sample at which the window begins that tells least
 * @property {Float64Array} matrix  of that window, n rows of n
 *
 * @typedef {object} PointsResult
 * @property {Settings} settings
 * @property {boolean} whole
 * @property {number} points       how many
 * @property {number} n            states
 * @property {string[]} names      of the states
 * @property {Float64Array} time   of the samples, in s
 * @property {Float64Array} truth  rows of n states
 * @property {Float64Array} estimate  rows of n states
 * @property {Float64Array} images  rows of the true y1, y2 of each point
 * @property {Float64Array} seenImages  the same, where they are seen
 * @property {Float64Array} outputs  the same, as they are sampled
 * @property {Float64Array} depths  rows of the true depth of each point, in m
 * @property {{images: Float64Array, depths: Float64Array}} estimated  the same of the estimate
 * @property {Float64Array} size   norm of the error at each sample
 * @property {Float64Array[]} errors  of each point, in m
 * @property {number} tolerance    of the largest of the next
 * @property {Float64Array} worst  the largest of the next at each sample
 * @property {number} settling  seconds until it stays in the tolerance, or Infinity
 * @property {Float64Array[]} relative  the same over each point's distance
 * @property {{rate: number, begin: number, level: number} | null} fit  the exponential fitted to the error's end
 * @property {{first: number, last: number, begin: number, end: number}[][]} absences  of each point: samples and times
 * @property {number | null} divergedAt  in s
 * @property {Gramian | null} gramian
 */

/**
 * @typedef {object} SettingSchema  what a setting may be, as a lab's schema has it by the setting's name
 * @property {"number" | "choice" | "names" | "matrix" | "list" | "group" | "several"} kind
 * @property {string} [label]      what the panel calls it
 * @property {string} [name]       what its control is called, if not as its place in the settings
 * @property {string} [unit]
 * @property {number} [low]        where its slider begins
 * @property {number} [high]       and ends
 * @property {number} [step]       of the slider
 * @property {boolean} [log]       whether the slider is logarithmic
 * @property {number} [least]      that may be typed
 * @property {number} [most]
 * @property {number} [above]      a limit that is itself not allowed
 * @property {boolean} [whole]     whether only whole numbers are allowed
 * @property {boolean} [nonzero]
 * @property {string} [topic]      part of the panel that shows it, unless the panel places it itself
 * @property {Record<string, string>} [choices]  words for each value; where they are missing the model knows them
 * @property {any} [entries]       schemas of a list's or a group's parts
 * @property {number} [rows]       of a matrix
 * @property {number} [columns]
 * @property {SettingSchema} [depth]  of points
 */

export {};
