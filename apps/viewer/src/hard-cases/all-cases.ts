/** The catalogue alone: only ever imported dynamically, so that the scripts of the viewer are counted without it. */
export { HARD_CASES } from '@websplatter/hardcases';
