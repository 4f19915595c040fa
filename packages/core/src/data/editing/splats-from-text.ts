import { InvalidArgumentError } from '../errors.ts';
import { checkKind, given, wrongArgument } from '../given.ts';
import { shown } from '../printable.ts';
import type { SplatSet } from '../splats/splat-set.ts';
import {
  checkPositive,
  drawingContext,
  type ImageSplatsOptions,
  splatsFromImage,
} from './splats-from-image.ts';

/** Options of `splatsFromText`. */
export interface TextSplatsOptions extends ImageSplatsOptions {
  /** Families, as in CSS's `font-family`; default `sans-serif`. */
  readonly font?: string;
  /** As CSS's `font-weight`; default 400. */
  readonly weight?: number | string;
  /** Size that the font is drawn in, pixels; default 64. More gives more and smaller splats. */
  readonly sizePx?: number;
  /** Any colour of CSS; default `white`. Emoji keep their own. */
  readonly color?: string;
  /** Where lines of different widths begin; default `left`. */
  readonly align?: 'left' | 'center' | 'right';
  /** Distance of two baselines, in parts of the font's size; default 1.2. */
  readonly lineHeight?: number;
  /** Distance of two pixels' centres, in the scene's units. Default: the font's size is 1 unit. */
  readonly pixelSize?: number;
}

/** Part of the room beside a line that lies to its left. */
const ALIGNMENTS = { left: 0, center: 0.5, right: 1 } as const;
/** Most pixels that text is drawn on, and along each side: canvases of all browsers have them. */
const MOST_PIXELS = 1 << 24;
const LONGEST_SIDE_PX = 1 << 14;
/** Room for the soft edges of letters. */
const MARGIN_PX = 1;

/**
 * Makes a set of flat splats of text, drawn on a canvas: see `splatsFromImage` for its plane and
 * front. The middle of the letters' extent is at the origin. Line breaks begin new lines.
 *
 * A font of the page must be there before, or a default takes its place:
 * `await document.fonts.load('64px Inter')`.
 *
 * @throws InvalidArgumentError naming the wrong option, or `text` if it draws no pixel or would draw
 *   too many; WebSplatterError `canvas-unavailable` where there is no canvas, as in Node.
 * @example
 * const set = splatsFromText('Hello', { font: 'Georgia, serif', weight: 700, color: 'orange' });
 * const cloud = engine.add(set);
 */
export function splatsFromText(text: string, options: TextSplatsOptions = {}): SplatSet {
  const { font = 'sans-serif', weight = 400, sizePx = 64, color = 'white' } = given(options);
  const { align = 'left', lineHeight = 1.2, pixelSize = 1 / sizePx } = options;
  checkKind('text', text, 'a string');
  checkPositive('sizePx', sizePx);
  checkPositive('lineHeight', lineHeight);
  if (!Object.hasOwn(ALIGNMENTS, align)) throw wrongArgument('align', align, 'left, center or right');
  const context = (width: number, height: number) => {
    const made = drawingContext(width, height, 'make text in a browser, and write it with writeSplats');
    setFont(made, `${weight} ${sizePx}px ${font}`, sizePx);
    setColor(made, color);
    return made;
  };

  const measuring = context(1, 1);
  const lines = text.split(/\r?\n/).map((line) => ({ line, metrics: measuring.measureText(line) }));
  const widest = lines.reduce((most, { metrics }) => Math.max(most, metrics.width), 0);
  const placed = lines.map(({ line, metrics }, i) => {
    const x = (widest - metrics.width) * ALIGNMENTS[align];
    const y = i * lineHeight * sizePx;
    const { actualBoundingBoxLeft: before, actualBoundingBoxRight: after } = metrics;
    const { actualBoundingBoxAscent: above, actualBoundingBoxDescent: below } = metrics;
    return { line, x, y, left: x - before, right: x + after, top: y - above, bottom: y + below };
  });
  // Blank lines draw nothing.
  const drawn = placed.filter(({ left, right, top, bottom }) => right > left && bottom > top);
  if (drawn.length === 0) throw blank(text);
  const least = (side: 'left' | 'top') => drawn.reduce((a, line) => Math.min(a, line[side]), drawn[0][side]);
  const most = (side: 'right' | 'bottom') =>
    drawn.reduce((a, line) => Math.max(a, line[side]), drawn[0][side]);
  const left = Math.floor(least('left')) - MARGIN_PX;
  const top = Math.floor(least('top')) - MARGIN_PX;
  const width = Math.ceil(most('right')) + MARGIN_PX - left;
  const height = Math.ceil(most('bottom')) + MARGIN_PX - top;
  if (width * height > MOST_PIXELS || Math.max(width, height) > LONGEST_SIDE_PX) {
    const message = `The text would be drawn on ${width} × ${height} pixels; it may have ${MOST_PIXELS}, and ${LONGEST_SIDE_PX} along a side. Give less text or a smaller sizePx.`;
    throw new InvalidArgumentError('text', message);
  }
  const drawing = context(width, height);
  for (const { line, x, y } of drawn) drawing.fillText(line, x - left, y - top);
  const set = splatsFromImage(drawing.getImageData(0, 0, width, height, { colorSpace: 'srgb' }), {
    ...options,
    pixelSize,
  });
  if (set.count === 0) throw blank(text);
  return set;
}

type Context = ReturnType<typeof drawingContext>;

/** Sets a font. Canvases keep the font before instead of one that they cannot read. */
function setFont(context: Context, font: string, sizePx: number): void {
  context.font = `${sizePx + 1}px serif`;
  const before = context.font;
  context.font = font;
  if (context.font === before) throw wrongArgument('font', font, 'families and a weight that CSS can read');
}

/** The same of colours: one that is kept depends on the one before. */
function setColor(context: Context, color: string): void {
  const taken = ['#000', '#fff'].map((before) => {
    context.fillStyle = before;
    context.fillStyle = color;
    return context.fillStyle;
  });
  if (taken[0] !== taken[1]) throw wrongArgument('color', color, 'a colour that CSS can read');
}

function blank(text: string): InvalidArgumentError {
  return new InvalidArgumentError('text', `The text is ${shown(text)}, which draws no pixel.`);
}
