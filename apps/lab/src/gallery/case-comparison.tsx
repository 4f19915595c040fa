import { CASE_RASTERIZERS, DEFAULT_SIZE_PX, MUTATIONS, type Mutation } from '@websplatter/conformance';
import { ACCURACY_PRESETS, type AccuracyPreset, type FrameRasterizer } from '@websplatter/core';
import { compareImages } from '@websplatter/core/reference';
import { Remote } from '@websplatter/core/write';
import { Choices } from '@websplatter/kit/choices';
import { ERROR_CLASSES } from '@websplatter/kit/error-classes';
import { formatDb } from '@websplatter/kit/format';
import { roundAbove } from '@websplatter/kit/nice-steps';
import { BLACK, type Pixels, shownBytes, stepsBetween } from '@websplatter/kit/shown-pixels';
import { workerFailure } from '@websplatter/kit/worker-failure';
import { type ComponentProps, useEffect, useMemo, useRef, useState } from 'react';
import type { CaseImage, CaseImages, ImageCase, SizePx } from './case-images.ts';
import type { ExpectedImage, ExpectedRequest, ExpectedTasks } from './expected.worker.ts';
import { useCaseImages } from './use-case-images.ts';

/** Requests float64 images from a worker, one at a time; caches the last one. */
export class ExpectedImages {
  readonly #createWorker: () => Worker;
  #remote: Remote<ExpectedTasks> | null = null;
  #kept: { readonly key: string; readonly image: ExpectedImage } | null = null;

  /** @param createWorker for tests. */
  constructor(createWorker = startWorker) {
    this.#createWorker = createWorker;
  }

  /** Ends the previous request, which may take long: its promise rejects. */
  async ask(request: ExpectedRequest): Promise<ExpectedImage> {
    const key = JSON.stringify(request);
    if (this.#remote?.waiting) this.destroy();
    if (this.#kept?.key === key) return this.#kept.image;
    if (!this.#remote || this.#remote.hasEnded)
      this.#remote = new Remote(this.#createWorker, { failure: workerFailure });
    const image = await this.#remote.call('draw', request);
    this.#kept = { key, image };
    return image;
  }

  destroy(): void {
    this.#remote?.end();
    this.#remote = null;
  }
}

function startWorker(): Worker {
  return new Worker(new URL('./expected.worker.ts', import.meta.url), { type: 'module' });
}

/** Colours from no difference to the largest, sRGB 0…255; lightness rises evenly. */
export const DIFFERENCE_COLORS = ERROR_CLASSES.map(({ color }) => color);

/** Difference of each pixel from the expected image, amplified to be visible. */
interface Difference {
  readonly pixels: Uint8ClampedArray<ArrayBuffer>;
  /** Difference with the lightest colour, in 8-bit steps; a round number, 0 for equal images. */
  readonly fullSteps: number;
  /** Largest difference of any channel, in steps of an 8-bit channel. */
  readonly maxSteps: number;
}

/** Compares images on black: the largest channel difference of each pixel. */
export function differenceOf(actual: Pixels, expected: Pixels): Difference {
  const steps = stepsBetween(actual, expected, BLACK);
  const maxSteps = steps.reduce((most, each) => Math.max(most, each), 0);
  const fullSteps = roundAbove(maxSteps);
  const pixels = new Uint8ClampedArray(actual.length);
  for (const [pixel, each] of steps.entries()) {
    pixels.set(colorAt(fullSteps > 0 ? each / fullSteps : 0), 4 * pixel);
    pixels[4 * pixel + 3] = 255;
  }
  return { pixels, fullSteps, maxSteps };
}

/** @param part position on the colour scale, 0…1. */
function colorAt(part: number): number[] {
  const last = DIFFERENCE_COLORS.length - 1;
  const place = part * last;
  const index = Math.min(last - 1, Math.floor(place));
  const [from, to] = [DIFFERENCE_COLORS[index], DIFFERENCE_COLORS[index + 1]];
  return from.map((channel, i) => Math.round(channel + (place - index) * (to[i] - channel)));
}

/** Settings of the compared images. */
interface Choice {
  readonly cameraName: string;
  readonly preset: AccuracyPreset;
  readonly rasterizer: FrameRasterizer;
  /** Size relative to the image in the tests. */
  readonly scale: number;
}

const PRESETS = Object.keys(ACCURACY_PRESETS) as AccuracyPreset[];
const LARGER = 4;
/** Largest image: float64 would take too long for larger ones. */
const MOST_PX = 1024;

/**
 * The expected image, this device's, and their difference, side by side. For cases about one
 * remedy, also this device's image by the classical formula, without the remedy.
 */
export function CaseComparison({ hardCase, images }: { hardCase: ImageCase; images: CaseImages }) {
  const own = hardCase.size ?? { widthPx: DEFAULT_SIZE_PX, heightPx: DEFAULT_SIZE_PX };
  const cameraNames = Object.keys(hardCase.cameras(own.widthPx / own.heightPx));
  const [choice, setChoice] = useState<Choice>({
    cameraName: cameraNames[0],
    preset: 'reference',
    rasterizer: CASE_RASTERIZERS[0],
    scale: 1,
  });
  const change = (part: Partial<Choice>) => setChoice({ ...choice, ...part });
  const size = useMemo(
    () => ({ widthPx: choice.scale * own.widthPx, heightPx: choice.scale * own.heightPx }),
    [choice.scale, own.widthPx, own.heightPx],
  );
  const canBeLarger = LARGER * Math.max(own.widthPx, own.heightPx) <= MOST_PX;
  const mutation = MUTATIONS.find(({ cases }) => cases.includes(hardCase.name));
  const { expected, actual, broken, problem } = useComparedImages(hardCase, images, choice, size, mutation);
  const difference = useMemo(
    () => (expected && actual ? differenceOf(actual.data, expected) : null),
    [expected, actual],
  );
  return (
    <section className="case-comparison" aria-label="Expected and actual">
      <div className="case-images">
        <Shown title="Expected" note="float64" image={expected} size={size} />
        <Shown
          title="This device"
          note={`${choice.preset}, ${choice.rasterizer}`}
          image={actual?.data ?? null}
          size={size}
        />
        <Shown title="Difference" note={gainOf(difference)} image={difference?.pixels ?? null} size={size} />
        {mutation && (
          <Shown
            title="Classical formula"
            note={`without ${mutation.remedy.replaceAll('-', ' ')}`}
            image={broken?.data ?? null}
            size={size}
          />
        )}
      </div>
      {difference && <Legend difference={difference} />}
      <p role="status" className="case-verdict" data-testid="case-verdict">
        {problem ??
          (expected && actual
            ? verdictOf(hardCase, actual, expected, choice, size)
            : 'Drawing, and working it out in float64…')}
      </p>
      {hardCase.decidesAtThreshold !== undefined && (
        <p className="note">
          Rounding may decide either way here, so the tests compare no images: {hardCase.decidesAtThreshold}
        </p>
      )}
      <div className="case-choices">
        {cameraNames.length > 1 && (
          <LabelledChoices
            label="Camera"
            testId="case-choose-"
            choices={cameraNames.map((name) => [name, name])}
            chosen={choice.cameraName}
            onChoose={(cameraName) => change({ cameraName })}
          />
        )}
        <LabelledChoices
          label="Accuracy"
          testId="case-choose-"
          choices={PRESETS.map((name) => [name, name])}
          chosen={choice.preset}
          onChoose={(preset) => change({ preset })}
        />
        <LabelledChoices
          label="Drawn by"
          testId="case-choose-"
          choices={CASE_RASTERIZERS.map((name) => [name, name])}
          chosen={choice.rasterizer}
          onChoose={(rasterizer) => change({ rasterizer })}
        />
        {canBeLarger && (
          <LabelledChoices
            label="Pixels"
            testId="case-choose-"
            choices={[1, LARGER].map((scale) => [scale, `${scale * own.widthPx}×${scale * own.heightPx}`])}
            chosen={choice.scale}
            onChoose={(scale) => change({ scale })}
          />
        )}
      </div>
    </section>
  );
}

interface Compared {
  /** Size of both images. */
  readonly size: SizePx;
  readonly expected: ExpectedImage | null;
  readonly actual: CaseImage | null;
  /** This device's image without the remedy; null until drawn. */
  readonly broken: CaseImage | null;
  /** Why this device's image or the expected one is missing; null if neither is. */
  readonly problem: string | null;
}

/** The images for a choice, which arrive one by one. */
function useComparedImages(
  hardCase: ImageCase,
  images: CaseImages,
  choice: Choice,
  size: SizePx,
  mutation: Mutation | undefined,
): Compared {
  const { cameraName, preset, rasterizer } = choice;
  const nothingYet = useMemo(
    () => ({ size, expected: null, actual: null, broken: null, problem: null }),
    [size],
  );
  const [compared, setCompared] = useState<Compared>(nothingYet);
  const [expectedImages] = useState(() => new ExpectedImages());
  useEffect(() => () => expectedImages.destroy(), [expectedImages]);
  const brokenImages = useCaseImages(mutation !== undefined, mutation);
  useEffect(() => {
    const changed = new AbortController();
    const add = (part: Partial<Compared>) => {
      if (!changed.signal.aborted) setCompared((before) => ({ ...before, ...part }));
    };
    const tell = (what: string) => (error: unknown) => {
      const reason = error instanceof Error ? error.message : String(error);
      add({ problem: `${what}: ${reason}` });
    };
    setCompared(nothingYet);
    const camera = hardCase.cameras(size.widthPx / size.heightPx)[cameraName];
    images
      .draw({ hardCase, camera, preset, rasterizer, ...size }, changed.signal)
      .then((actual) => add({ actual }), tell('This device could not draw the image'));
    brokenImages
      ?.draw({ hardCase, camera, preset, rasterizer, ...size }, changed.signal)
      // Without the remedy, pixels may be NaN and the device may be lost.
      .then(
        (broken) => add({ broken }),
        () => {},
      );
    expectedImages
      .ask({ name: hardCase.name, cameraName, ...size })
      .then((expected) => add({ expected }), tell('The float64 image could not be computed'));
    return () => changed.abort();
  }, [hardCase, images, expectedImages, brokenImages, cameraName, preset, rasterizer, size, nothingYet]);
  // Images of the previous size no longer apply.
  return compared.size === size ? compared : nothingYet;
}

function gainOf(difference: Difference | null): string {
  if (!difference) return '';
  const { fullSteps } = difference;
  return fullSteps > 0 ? `× ${Number((255 / fullSteps).toPrecision(3)).toLocaleString('en')}` : 'none';
}

/** PSNR as text, with the tests' bound if they draw the same image. */
function verdictOf(
  hardCase: ImageCase,
  { data, minPsnrDb }: CaseImage,
  expected: ExpectedImage,
  { scale, preset }: Choice,
  size: SizePx,
): string {
  const { psnrDb } = compareImages(data, expected, size);
  const found =
    psnrDb === Number.POSITIVE_INFINITY ? 'Identical to float64.' : `PSNR ${formatDb(psnrDb)} dB.`;
  if (scale !== 1 || hardCase.decidesAtThreshold !== undefined) return found;
  if (minPsnrDb === null) return `${found} The tests only report it at ${preset}.`;
  const cause = hardCase.bounds?.[preset]?.cause;
  const demand = `The tests demand ${minPsnrDb} dB${cause ? `: ${cause}` : '.'}`;
  return `${found} ${psnrDb >= minPsnrDb ? '✓' : '✕'} ${demand}`;
}

function Shown(props: {
  title: string;
  note: string;
  /** Bytes, or a premultiplied image to show on black. */
  image: Difference['pixels'] | Pixels | null;
  size: SizePx;
}) {
  const { title, note, image, size } = props;
  const canvas = useRef<HTMLCanvasElement>(null);
  const { widthPx, heightPx } = size;
  const pixels = useMemo(
    () => image && (image instanceof Uint8ClampedArray ? image : shownBytes(image, BLACK)),
    [image],
  );
  useEffect(() => {
    const context = canvas.current?.getContext('2d');
    if (pixels) context?.putImageData(new ImageData(pixels, widthPx, heightPx), 0, 0);
    else context?.clearRect(0, 0, widthPx, heightPx);
  }, [pixels, widthPx, heightPx]);
  return (
    <figure>
      <canvas
        ref={canvas}
        width={widthPx}
        height={heightPx}
        role="img"
        aria-label={`${title}, ${note}`}
        data-shown={pixels !== null}
      />
      <figcaption>
        <b>{title}</b> <span>{note}</span>
      </figcaption>
    </figure>
  );
}

/** Explains the colours of the difference. */
function Legend({ difference: { fullSteps, maxSteps } }: { difference: Difference }) {
  const stops = DIFFERENCE_COLORS.map((color) => `rgb(${color.join(' ')})`);
  return (
    <p className="case-legend" data-testid="case-legend">
      <span>0</span>
      <i style={{ background: `linear-gradient(90deg, ${stops.join(', ')})` }} aria-hidden="true" />
      <span>{fullSteps > 0 ? fullSteps : 'any'} of 255</span>
      <span>
        Largest difference of a channel: <b>{Number(maxSteps.toPrecision(2))}</b> of 255
      </span>
    </p>
  );
}

function LabelledChoices<Value>({ label, ...choices }: ComponentProps<typeof Choices<Value>>) {
  return (
    <div className="case-choice">
      <span aria-hidden="true">{label}</span>
      <Choices label={label} {...choices} />
    </div>
  );
}
