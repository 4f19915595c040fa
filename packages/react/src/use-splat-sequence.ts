import { callListener, checkAccuracy } from '@websplatter/core';
import type { SplatFrames } from '@websplatter/core/frames';
import { findSplatEngine, type SplatData, SplatLoader } from '@websplatter/three';
import { SplatSequence, type SplatSequenceOptions } from '@websplatter/three/sequence';
import { type RefObject, useCallback, useEffect, useRef, useState } from 'react';
import { LoadingManager } from 'three';
import type { SplatFileSource } from './splat-cache.ts';
import { useLatest, useSame } from './stable-values.ts';
import { useCanvasRenderer } from './use-renderer.ts';
import type { UseSplatsOptions } from './use-splats.ts';

/** Options of `useSplatSequence`. */
export interface UseSplatSequenceOptions
  extends SplatSequenceOptions,
    Pick<UseSplatsOptions, 'accuracy' | 'sourceOptions'> {
  /** See `SplatSequence.onError`. */
  readonly onError?: (error: unknown, frame: number) => void;
}

/** State of a sequence. */
export interface SplatSequenceState {
  /** Splats of the present frame, for `<Splats src={data}>`; null until the first frame is loaded. */
  readonly data: SplatData | null;
  /** Index of the frame in `data`; 0 before the first. */
  readonly frame: number;
  readonly frameCount: number;
  /** Whether playback waits for a frame: at the beginning, after a seek, or in a stall. */
  readonly isBuffering: boolean;
  /** Loaded frames that were skipped because the page was late. */
  readonly droppedFrames: number;
  /** See `SplatSequence.seek`; the same function in every render. */
  readonly seek: SplatSequence['seek'];
}

type Shown = Omit<SplatSequenceState, 'frameCount' | 'seek'>;

/**
 * Plays files one after the other, or one file of frames, as `SplatSequence` does, into the GPU memory of
 * the surrounding Canvas if there is one. Does not suspend; renders again when the frame or `isBuffering` changes.
 * A list with other sources starts a new sequence; the present frame stays until its first frame is
 * loaded. `framesPerS`, `isPlaying` and `loop` may change at any time; other options are read when a
 * sequence starts. On a server, nothing is read.
 *
 * @param sources sources of the frames, in order; or one source of a file of frames (`.frames`), which
 *   gives the default of `framesPerS` and is read as it is played. URLs are compared by text,
 *   everything else by identity.
 * @throws InvalidArgumentError as SplatSequence does; SplatsUnsupportedRendererError in a Canvas
 *   whose renderer cannot draw splats.
 * @example
 * function Dancer({ isPlaying }: { isPlaying: boolean }) {
 *   const frames = ['1.spz', '2.spz', '3.spz'];
 *   const { data } = useSplatSequence(frames, { framesPerS: 24, isPlaying });
 *   return <Splats src={data} />;
 * }
 */
export function useSplatSequence(
  sources: readonly SplatFileSource[] | SplatFileSource,
  options: UseSplatSequenceOptions = {},
): SplatSequenceState {
  const renderer = useCanvasRenderer();
  if (renderer) findSplatEngine(renderer);
  if (options.accuracy) checkAccuracy(options.accuracy);
  const latest = useLatest(options);
  const [file, given] = isList(sources) ? [null, sources] : [sources, []];
  const { opened, isOpening } = useOpenedFile(file instanceof URL ? file.href : file, latest);
  const ownRate = opened?.framesPerS;
  const all = opened?.frames ?? given;
  const list = useSame(all.map((source) => (source instanceof URL ? source.href : source)));
  const sequence = useRef<SplatSequence>(null);
  const [known, setKnown] = useState<{ readonly list: object; readonly shown: Shown } | null>(null);
  useEffect(() => {
    // An empty list must not show a frame of the list before.
    if (list.length === 0 && !isOpening) setKnown(null);
    // Frames load too often for progress bars, which use three's default manager.
    const manager = new LoadingManager();
    const { accuracy, sourceOptions = {} } = latest.current;
    const makeLoader = () => {
      const loader = new SplatLoader(manager);
      loader.sourceOptions = sourceOptions;
      if (accuracy) loader.setAccuracy(accuracy);
      return renderer ? loader.detectSupport(renderer) : loader;
    };
    const { framesPerS = ownRate } = latest.current;
    const made = new SplatSequence(list, makeLoader, { ...latest.current, framesPerS });
    sequence.current = made;
    made.onError = (error, frame) => {
      if (latest.current.onError) callListener(latest.current.onError, error, frame);
      else console.error(error);
    };
    made.addEventListener('change', () => {
      const { data, frame, isBuffering, droppedFrames } = made;
      setKnown((before) => ({
        list,
        shown: { data: data ?? before?.shown.data ?? null, frame, isBuffering, droppedFrames },
      }));
    });
    return () => made.dispose();
  }, [list, isOpening, ownRate, renderer, latest]);
  const { framesPerS = ownRate ?? 30, isPlaying = true, loop = true } = options;
  useEffect(() => {
    if (sequence.current) Object.assign(sequence.current, { framesPerS, isPlaying, loop });
  });
  const seek = useCallback<SplatSequence['seek']>((place) => sequence.current?.seek(place), []);
  const frameCount = list.length;
  if (known?.list === list) return { ...known.shown, frameCount, seek };
  const isBuffering = frameCount > 0 || isOpening;
  const data = (isBuffering && known?.shown.data) || null;
  return { data, frame: 0, frameCount, isBuffering, droppedFrames: 0, seek };
}

function isList(
  sources: readonly SplatFileSource[] | SplatFileSource,
): sources is readonly SplatFileSource[] {
  return Array.isArray(sources);
}

/** The frames of a file; null before it is opened, if it cannot be, and without a file. */
function useOpenedFile(
  file: SplatFileSource | null,
  latest: RefObject<UseSplatSequenceOptions>,
): { readonly opened: SplatFrames | null; readonly isOpening: boolean } {
  const [known, setKnown] = useState<{ readonly file: unknown; readonly opened: SplatFrames | null }>();
  useEffect(() => {
    if (file === null) return;
    const ending = new AbortController();
    let opened: SplatFrames | null = null;
    const open = async () => {
      const { openFrames } = await import('@websplatter/core/frames');
      opened = await openFrames(file, { ...latest.current.sourceOptions, signal: ending.signal });
      if (ending.signal.aborted) opened.end();
      else setKnown({ file, opened });
    };
    open().catch((error) => {
      if (ending.signal.aborted) return;
      setKnown({ file, opened });
      if (latest.current.onError) callListener(latest.current.onError, error, 0);
      else console.error(error);
    });
    return () => {
      ending.abort();
      opened?.end();
    };
  }, [file, latest]);
  if (file === null) return { opened: null, isOpening: false };
  return known?.file === file ? { ...known, isOpening: false } : { opened: null, isOpening: true };
}
