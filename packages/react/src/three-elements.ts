import type { ThreeElement } from '@react-three/fiber';
import type { SplatCloudObject } from '@websplatter/three';

/** For those who write `<splatCloudObject data={…} />` after `extend({ SplatCloudObject })`. */
declare module '@react-three/fiber' {
  interface ThreeElements {
    splatCloudObject: ThreeElement<typeof SplatCloudObject>;
  }
}
