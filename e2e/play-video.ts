import type { DecodedImage } from './png.ts';

/** What `playVideo` has seen: pages send numbers, not bytes. */
interface SeenVideo {
  readonly durationS: number;
  readonly frames: readonly {
    readonly widthPx: number;
    readonly heightPx: number;
    readonly data: number[];
  }[];
}

export interface Playback {
  readonly durationS: number;
  readonly first: DecodedImage;
  readonly last: DecodedImage;
}

export function playbackOf({ durationS, frames }: SeenVideo): Playback {
  const [first, last] = frames.map((each) => ({ ...each, data: Uint8Array.from(each.data) }));
  return { durationS, first, last };
}

/** For any browser's `evaluate`: plays a video to its end, then shows its first and last frames. */
export async function playVideo({ base64, type }: { base64: string; type: string }): Promise<SeenVideo> {
  const bytes = Uint8Array.from(atob(base64), (character) => character.charCodeAt(0));
  const player = document.createElement('video');
  const event = (name: string) =>
    new Promise((resolve, reject) => {
      player.addEventListener(name, resolve, { once: true });
      player.addEventListener('error', () => reject(new Error(player.error?.message)), { once: true });
    });
  const loaded = event('loadeddata');
  player.muted = true;
  player.src = URL.createObjectURL(new Blob([bytes], { type }));
  await loaded;
  const ended = event('ended');
  player.playbackRate = 4;
  await player.play();
  await ended;
  const { videoWidth: widthPx, videoHeight: heightPx, duration } = player;
  const context = new OffscreenCanvas(widthPx, heightPx).getContext('2d')!;
  const shownAt = async (seconds: number) => {
    // At `seeked`, a busy browser may still show the frame before.
    const presented = new Promise<void>((resolve) => {
      const look: VideoFrameRequestCallback = (_now, { mediaTime }) => {
        if (Math.abs(mediaTime - seconds) < 0.04) resolve();
        else player.requestVideoFrameCallback(look);
      };
      player.requestVideoFrameCallback(look);
    });
    player.currentTime = seconds;
    await presented;
    context.drawImage(player, 0, 0);
    return { widthPx, heightPx, data: [...context.getImageData(0, 0, widthPx, heightPx).data] };
  };
  return { durationS: duration, frames: [await shownAt(0.001), await shownAt(duration - 0.001)] };
}
