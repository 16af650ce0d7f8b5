"""How well tracks fit true ones: metrics of tracking several targets."""
