import { type Choice, Choices } from '@websplatter/kit/choices';
import { TextButton } from '@websplatter/kit/controls';
import { formatCount } from '@websplatter/kit/format';
import { useEffect, useState } from 'react';
import { useStore } from 'zustand';
import type { PanelProps } from '../engine/panel-props.ts';
import { pathMs, pathThrough } from '../navigate/view-path.ts';
import { Running } from '../ui/running.tsx';
import {
  FRAME_RATES,
  type FrameRate,
  findCodec,
  frameCount,
  type VideoCodec,
  videoSize,
} from './video-format.ts';
import { videosOf } from './videos.ts';

/** Pixels over the shorter side; null for the window's size. */
const SIZES: readonly Choice<number | null>[] = [
  [null, 'As shown', 'as-shown'],
  [720, '720p', '720p'],
  [1080, '1080p', '1080p'],
  [2160, '4K', '4k'],
];

/** Saves the path through the saved views as a video. */
export function VideoSection({ store, viewer }: PanelProps) {
  const videos = videosOf(viewer, store);
  const widthPx = useStore(store, (state) => state.widthPx);
  const heightPx = useStore(store, (state) => state.heightPx);
  const filming = useStore(store, (state) => state.filming);
  const savedViews = useStore(store, (state) => state.savedViews);
  const hasPicture = useStore(store, (state) => state.imageId > 0);
  const [lines, setLines] = useState<number | null>(null);
  const [framesPerS, setFramesPerS] = useState<FrameRate>(FRAME_RATES[0]);
  const [videoWidthPx, videoHeightPx] = videoSize(lines, [widthPx, heightPx]);
  const codec = useCodec(videoWidthPx, videoHeightPx, framesPerS);
  const views = pathThrough(savedViews).length;
  const isPossible = views > 1 && 'VideoEncoder' in globalThis;
  return (
    <section>
      <h3>Video along saved views</h3>
      {isPossible && (
        <>
          <Choices
            label="Size of the video"
            isChips
            choices={SIZES}
            chosen={lines}
            testId="video-"
            onChoose={setLines}
          />
          <div className="spread picture-row">
            <span>Frames per second</span>
            <Choices
              label="Frames per second"
              isChips
              choices={FRAME_RATES.map((rate) => [rate, `${rate}`])}
              chosen={framesPerS}
              testId="video-rate-"
              onChoose={setFramesPerS}
            />
          </div>
        </>
      )}
      {filming ? (
        <Running
          label={`Frame ${formatCount(filming.drawnFrames)} of ${formatCount(filming.frames)}`}
          about={`Drawing ${filming.fileName}`}
          value={filming.drawnFrames}
          max={filming.frames}
          onCancel={() => videos.cancel()}
          testId="filming"
          cancelId="cancel-video"
        />
      ) : (
        <div className="runner">
          <p data-testid="video-about">
            {codec === null
              ? noEncoder(lines)
              : views < 2
                ? 'The video follows the path through saved views: save two or more in View and camera (V).'
                : `${views} views, ${pathMs(views) / 1000} s, ${formatCount(frameCount(views, framesPerS))} frames of ${videoWidthPx} × ${videoHeightPx} px, all at full detail.`}
          </p>
          <TextButton
            look="primary"
            disabled={!hasPicture || !codec || views < 2}
            testId="save-video"
            onClick={() => codec && void videos.start({ codec, framesPerS })}
          >
            Save .webm
          </TextButton>
        </div>
      )}
    </section>
  );
}

/** Null where the browser has none; undefined until that is known. */
function useCodec(widthPx: number, heightPx: number, framesPerS: FrameRate): VideoCodec | null | undefined {
  const [codec, setCodec] = useState<VideoCodec | null>();
  useEffect(() => {
    let isStale = false;
    setCodec(undefined);
    void findCodec([widthPx, heightPx], framesPerS).then((found) => {
      if (!isStale) setCodec(found);
    });
    return () => {
      isStale = true;
    };
  }, [widthPx, heightPx, framesPerS]);
  return codec;
}

function noEncoder(lines: number | null): string {
  if (!('VideoEncoder' in globalThis))
    return 'This browser cannot encode videos: it has no VideoEncoder. Chromium, Firefox and Safari have one in newer versions.';
  return `This browser encodes neither VP9, AV1 nor VP8 at this size. ${lines === null ? 'A smaller window' : 'A smaller size'} may help.`;
}
