"""The reference reading of USD, by OpenUSD's own parser of the physics schemas."""
