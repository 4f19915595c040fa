import { type Choice, Choices } from '@websplatter/kit/choices';
import { TextButton } from '@websplatter/kit/controls';
import { formatBytes, formatCount, formatDuration } from '@websplatter/kit/format';
import { Icon } from '@websplatter/kit/icon';
import { useEffect, useMemo, useState } from 'react';
import { useStore } from 'zustand';
import type { PanelProps } from '../engine/viewer.ts';
import { TURNTABLE_MS } from '../navigate/saved-views.ts';
import { showPath } from '../navigate/show-path.ts';
import { useSavedViews } from '../navigate/thumbnails.tsx';
import { pathOf } from '../navigate/view-path.ts';
import { useSceneTiming } from '../scene/time-bar.tsx';
import type { FilmingState } from '../state/saving.ts';
import { Running } from '../ui/running.tsx';
import {
  CONTAINERS,
  type Container,
  codecNames,
  FRAME_RATES,
  type FrameRate,
  findCodec,
  frameCount,
  type VideoCodec,
  type VideoQuality,
  videoSize,
  withQuality,
} from './video-format.ts';
import { type VideoChoices, videosOf } from './videos.ts';

type Lines = VideoChoices['lines'];
const SIZES: readonly Choice<Lines>[] = [
  [null, 'As shown', 'as-shown'],
  [720, '720p', '720p'],
  [1080, '1080p', '1080p'],
  [2160, '4K', '4k'],
];
const FORMATS: readonly Choice<Container>[] = [
  ['mp4', 'MP4'],
  ['webm', 'WebM'],
];
const QUALITY_CHOICES: readonly Choice<VideoQuality>[] = [
  ['small', 'Small file'],
  ['good', 'Good'],
  ['best', 'Best'],
];

/** Videos whose frames are drawn sooner are ready before their duration matters. */
const TOLD_FROM_MS = 10_000;

/** Saves the camera path as a video. */
export function VideoSection({ store, viewer }: PanelProps) {
  const filming = useStore(store, (state) => state.filming);
  const savedViews = useStore(store, (state) => state.savedViews);
  const settings = useStore(store, (state) => state.path);
  const path = useMemo(() => pathOf({ savedViews, path: settings }), [savedViews, settings]);
  const hasPicture = useStore(store, (state) => state.imageId > 0);
  const isPlaying = useStore(store, (state) => state.isPathPlaying);
  const views = useSavedViews({ store, viewer });
  return (
    <section>
      <h3>Video along the camera path</h3>
      {filming ? (
        <FilmingProgress store={store} viewer={viewer} filming={filming} />
      ) : (
        <>
          {!('VideoEncoder' in globalThis) ? (
            <p data-testid="video-about">{NO_ENCODER}</p>
          ) : path ? (
            <VideoForm store={store} viewer={viewer} path={path} />
          ) : (
            <p data-testid="video-about">
              There is no path yet. A turntable goes once around what this view looks at, in{' '}
              {TURNTABLE_MS / 1000} s. Or save two or more views: the path leads through them.
            </p>
          )}
          <div className="page-kinds">
            <TextButton
              aria-pressed={settings.turntable !== null}
              disabled={!hasPicture}
              title="Once around what this view looks at"
              testId="video-turntable"
              onClick={() => views.setTurntable(settings.turntable ? null : TURNTABLE_MS)}
            >
              <Icon name="turntable" />
              Turntable
            </TextButton>
            <TextButton disabled={!hasPicture} testId="video-path" onClick={() => showPath(store, true)}>
              <Icon name="path" />
              {path ? 'Change the path' : 'Make a path'}
            </TextButton>
            {path && (
              <TextButton
                disabled={!hasPicture}
                title="Shows the path in the picture, before it is a video"
                testId="preview-path"
                onClick={() => views.togglePlaying()}
              >
                <Icon name={isPlaying ? 'pause' : 'play'} />
                {isPlaying ? 'Pause' : 'Preview'}
              </TextButton>
            )}
          </div>
        </>
      )}
    </section>
  );
}

const NO_ENCODER =
  'This browser cannot encode videos: it has no VideoEncoder. Chromium, Firefox and Safari have one in newer versions.';

/** A video that is being made while its panel is closed. */
export function FilmingCard({ store, viewer }: PanelProps) {
  const filming = useStore(store, (state) => state.filming);
  if (!filming) return null;
  return (
    <section className="panel load" aria-label={`Drawing ${filming.fileName}`} data-testid="filming-card">
      <strong className="load-title">{filming.fileName}</strong>
      <FilmingProgress store={store} viewer={viewer} filming={filming} />
    </section>
  );
}

function FilmingProgress({ store, viewer, filming }: PanelProps & { filming: FilmingState }) {
  return (
    <Running
      label={progressText(filming)}
      about={`Drawing ${filming.fileName}`}
      value={filming.drawnFrames}
      max={filming.frames}
      onCancel={() => videosOf(viewer, store).cancel()}
      testId="filming"
      cancelId="cancel-video"
    />
  );
}

/** `Frame 7 of 76 · 40 s left`. */
function progressText({ drawnFrames, frames, leftMs }: FilmingState): string {
  const left = leftMs === null ? '' : ` · ${formatDuration(leftMs)} left`;
  return `Frame ${formatCount(drawnFrames)} of ${formatCount(frames)}${left}`;
}

function VideoForm({ store, viewer, path }: PanelProps & { path: NonNullable<ReturnType<typeof pathOf>> }) {
  const widthPx = useStore(store, (state) => state.widthPx);
  const heightPx = useStore(store, (state) => state.heightPx);
  const hasPicture = useStore(store, (state) => state.imageId > 0);
  const isMoving = useSceneTiming({ store, viewer }) !== null;
  const isTurntable = useStore(store, (state) => state.path.turntable !== null);
  const frameMs = useStore(store, (state) => state.statistics?.timing.totalMs ?? 0);
  const videos = videosOf(viewer, store);
  const [{ container: asked, lines, framesPerS, quality }, setChoices] = useState(videos.choices);
  const choose = (change: Partial<VideoChoices>) => {
    videos.choices = { ...videos.choices, ...change };
    setChoices(videos.choices);
  };
  const codecs = useCodecs(widthPx, heightPx);
  const offer = (container: Container, of: Lines, rate: FrameRate) =>
    codecs?.get(codecKey(container, of, rate)) ?? null;
  const hasAny = (of: Lines, rate: FrameRate) => CONTAINERS.some((each) => offer(each, of, rate));
  const container = [asked, ...CONTAINERS].find((each) => offer(each, lines, framesPerS)) ?? asked;
  const found = offer(container, lines, framesPerS);
  const codec = found && withQuality(found, quality);
  const whyNot = (isPossible: boolean, reason: string) => (codecs && !isPossible ? reason : null);
  const whyNoFormat = (each: Container) =>
    whyNot(
      offer(each, lines, framesPerS) !== null,
      `This browser encodes no ${codecNames(each)} for ${each === 'mp4' ? 'MP4' : 'WebM'} at this size and rate.`,
    );
  const missing = CONTAINERS.map(whyNoFormat).find((why) => why !== null);
  const [videoWidthPx, videoHeightPx] = videoSize(lines, [widthPx, heightPx]);
  const frames = frameCount(path, framesPerS);
  const drawnMs =
    frameMs * frames * Math.max(1, (videoWidthPx * videoHeightPx) / Math.max(1, widthPx * heightPx));
  const seconds = (path.durationMs / 1000).toFixed(1).replace('.0', '');
  return (
    <>
      <div className="spread picture-row">
        <span>Format</span>
        <Choices
          label="Format of the video"
          isChips
          choices={FORMATS}
          chosen={container}
          testId="video-"
          whyNotOf={whyNoFormat}
          onChoose={(each) => choose({ container: each })}
        />
      </div>
      {missing && codec && <p data-testid="video-missing">{missing}</p>}
      <Choices
        label="Size of the video"
        isChips
        choices={SIZES}
        chosen={lines}
        testId="video-"
        whyNotOf={(each) =>
          whyNot(hasAny(each, framesPerS), `This browser cannot encode this size at ${framesPerS} a second.`)
        }
        onChoose={(each) => choose({ lines: each })}
      />
      <div className="spread picture-row">
        <span>Frames per second</span>
        <Choices
          label="Frames per second"
          isChips
          choices={FRAME_RATES.map((rate) => [rate, `${rate}`])}
          chosen={framesPerS}
          testId="video-rate-"
          whyNotOf={(each) => whyNot(hasAny(lines, each), 'This browser cannot encode this size so fast.')}
          onChoose={(each) => choose({ framesPerS: each })}
        />
      </div>
      <div className="spread picture-row">
        <span>Quality</span>
        <Choices
          label="Quality of the video"
          isChips
          choices={QUALITY_CHOICES}
          chosen={quality}
          testId="video-quality-"
          onChoose={(each) => choose({ quality: each })}
        />
      </div>
      <div className="runner">
        <p data-testid="video-about">
          {codecs && !codec
            ? `This browser can encode no video of this size. ${lines === null ? 'A smaller window' : 'A smaller size'} may help.`
            : [
                isTurntable ? 'Turntable' : `${path.keys.length} views`,
                `${seconds} s`,
                `${formatCount(frames)} frames of ${videoWidthPx} × ${videoHeightPx} px`,
                ...(codec ? [`about ${formatBytes((codec.config.bitrate * frames) / framesPerS / 8)}`] : []),
              ].join(', ')}
          {codec && '. Every frame is drawn at full detail.'}
          {codec && isMoving && ' The scene plays from the time shown.'}
          {codec && drawnMs > TOLD_FROM_MS && ` On this device that takes about ${formatDuration(drawnMs)}.`}
        </p>
        <TextButton
          disabled={!hasPicture || !codec}
          testId="save-video"
          onClick={() => codec && void videos.start({ codec, framesPerS })}
        >
          Save .{container}
        </TextButton>
      </div>
    </>
  );
}

const codecKey = (container: Container, lines: Lines, framesPerS: FrameRate) =>
  `${container} ${lines} ${framesPerS}`;

/** Codecs that this browser has, by container, size and rate; null until that is known. */
function useCodecs(widthPx: number, heightPx: number): ReadonlyMap<string, VideoCodec | null> | null {
  const [codecs, setCodecs] = useState<ReadonlyMap<string, VideoCodec | null> | null>(null);
  useEffect(() => {
    let isStale = false;
    setCodecs(null);
    const all = CONTAINERS.flatMap((container) =>
      SIZES.flatMap(([lines]) =>
        FRAME_RATES.map(async (rate) => {
          const found = await findCodec(container, videoSize(lines, [widthPx, heightPx]), rate);
          return [codecKey(container, lines, rate), found] as const;
        }),
      ),
    );
    void Promise.all(all).then((entries) => {
      if (!isStale) setCodecs(new Map(entries));
    });
    return () => {
      isStale = true;
    };
  }, [widthPx, heightPx]);
  return codecs;
}
