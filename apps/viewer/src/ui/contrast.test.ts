import { readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';

type Rgb = readonly [number, number, number];

const TOKENS = ['./tokens.css', '../../../kit/src/tokens.css']
  .map((path) => readFileSync(new URL(path, import.meta.url), 'utf8'))
  .join('\n');
const BLACK: Rgb = [0, 0, 0];
const WHITE: Rgb = [255, 255, 255];
/** WCAG 2.2, AA, for text. */
const LEAST_CONTRAST = 4.5;

interface Color {
  readonly rgb: Rgb;
  readonly alpha: number;
}

/** Colour of a token in the light and the dark theme. */
function token(name: string): { light: Color; dark: Color } {
  const [, light, dark] =
    new RegExp(`--${name}: light-dark\\((#\\w+|rgb\\(.*?\\)), (#\\w+|rgb\\(.*?\\))\\)`).exec(TOKENS) ?? [];
  if (!light || !dark) throw new Error(`tokens.css has no --${name} for both themes.`);
  return { light: parsed(light), dark: parsed(dark) };
}

function parsed(text: string): Color {
  if (text.startsWith('#'))
    return {
      rgb: [1, 3, 5].map((at) => Number.parseInt(text.slice(at, at + 2), 16)) as unknown as Rgb,
      alpha: 1,
    };
  const [red, green, blue, percent] = text.match(/\d+/g)!.map(Number);
  return { rgb: [red, green, blue], alpha: percent / 100 };
}

function over({ rgb, alpha }: Color, below: Rgb): Rgb {
  return rgb.map((value, i) => value * alpha + below[i] * (1 - alpha)) as unknown as Rgb;
}

function luminance(rgb: Rgb): number {
  const [red, green, blue] = rgb.map((value) =>
    value <= 10.31475 ? value / 255 / 12.92 : ((value / 255 + 0.055) / 1.055) ** 2.4,
  );
  return 0.2126 * red + 0.7152 * green + 0.0722 * blue;
}

function contrast(a: Rgb, b: Rgb): number {
  const [high, low] = [luminance(a), luminance(b)].sort((x, y) => y - x);
  return (high + 0.05) / (low + 0.05);
}

describe.each(['light', 'dark'] as const)('the %s theme', (theme) => {
  // Panels let the image through: the worst is one that takes the contrast away.
  const panel = over(token('surface')[theme], theme === 'light' ? BLACK : WHITE);
  const hovered = over(token('hover')[theme], panel);
  const solid = token('surface-solid')[theme].rgb;

  it.each(['text', 'text-muted', 'accent', 'danger', 'warning'])('has legible %s on any panel', (name) => {
    const { rgb } = token(name)[theme];
    for (const below of [panel, hovered, solid])
      expect(contrast(rgb, below)).toBeGreaterThanOrEqual(LEAST_CONTRAST);
  });

  it('has legible text on what is chosen', () => {
    const chosen = token('accent')[theme].rgb;
    expect(contrast(token('on-accent')[theme].rgb, chosen)).toBeGreaterThanOrEqual(LEAST_CONTRAST);
  });
});
