/** Effects by three's nodes (`@websplatter/react/tsl`): those of @websplatter/three/tsl. */
export * from '@websplatter/three/tsl';
